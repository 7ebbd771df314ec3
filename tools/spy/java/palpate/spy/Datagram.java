package palpate.spy;

import java.nio.charset.StandardCharsets;

/**
 * LCM's framing of a short message: the magic "LC02", a number, the channel's name with its zero,
 * the payload. Reads nothing beyond the received bytes.
 */
final class Datagram {
  static final int HEADER_SIZE = 8;
  static final int LONGEST_CHANNEL = 63;

  final String channel;
  final int payloadAt;
  final int payloadSize;

  private Datagram(String channel, int payloadAt, int payloadSize) {
    this.channel = channel;
    this.payloadAt = payloadAt;
    this.payloadSize = payloadSize;
  }

  /** Null unless `size` bytes of `data` hold exactly one complete short message. */
  static Datagram parse(byte[] data, int size) {
    if (size < HEADER_SIZE || size > data.length) return null;
    if (data[0] != 'L' || data[1] != 'C' || data[2] != '0' || data[3] != '2') return null;
    int end = HEADER_SIZE;
    int last = Math.min(size, HEADER_SIZE + LONGEST_CHANNEL + 1);
    while (end < last && data[end] != 0) ++end;
    if (end == last || end == HEADER_SIZE) return null;
    String name =
        new String(data, HEADER_SIZE, end - HEADER_SIZE, StandardCharsets.ISO_8859_1);
    return new Datagram(name, end + 1, size - end - 1);
  }
}
