package palpate.spy;

import java.io.IOException;
import java.net.DatagramPacket;
import java.net.InetAddress;
import java.net.InetSocketAddress;
import java.net.MulticastSocket;
import lcm.lcm.LCM;

/**
 * Receives the short messages of one LCM URL for the spy. LCM's own receiver for Java stops without
 * a message at the first packet that it cannot read; this one counts it and continues.
 */
final class Receiver extends Thread {
  private static final int BUFFER_SIZE = 65536;
  private static final int WANTED_QUEUE = 4 << 20;

  private final Url url;
  private final LCM into;
  private final MulticastSocket socket;
  private volatile long rejected;

  Receiver(Url url, LCM into) throws IOException {
    super("receive " + url.text);
    this.url = url;
    this.into = into;
    InetAddress group = InetAddress.getByName(url.address);
    // Bound to the group, not to any address, the socket receives this group only.
    socket = new MulticastSocket(new InetSocketAddress(group, url.port));
    socket.setReceiveBufferSize(WANTED_QUEUE);
    socket.joinGroup(new InetSocketAddress(group, url.port), null);
    setDaemon(true);
  }

  /** Datagrams that were not short messages, or that the spy could not decode. */
  long rejected() {
    return rejected;
  }

  @Override
  public void run() {
    byte[] buffer = new byte[BUFFER_SIZE];
    DatagramPacket packet = new DatagramPacket(buffer, buffer.length);
    while (true) {
      try {
        packet.setLength(buffer.length);
        socket.receive(packet);
      } catch (IOException error) {
        System.err.println("palpate-spy: " + url.text + ": " + error.getMessage());
        return;
      }
      Datagram datagram = Datagram.parse(buffer, packet.getLength());
      if (datagram == null) {
        ++rejected;
        continue;
      }
      try {
        // The spy's tables are not made for several receivers.
        synchronized (into) {
          into.receiveMessage(datagram.channel, buffer, datagram.payloadAt, datagram.payloadSize);
        }
      } catch (RuntimeException | OutOfMemoryError error) {
        ++rejected;
      }
    }
  }
}
