package palpate.spy;

/** udpm://ADDRESS:PORT with options, which a receiver ignores. */
final class Url {
  final String text;
  final String address;
  final int port;

  /** Throws IllegalArgumentException with the reason. */
  Url(String text) {
    this.text = text;
    String scheme = "udpm://";
    if (!text.startsWith(scheme)) throw wrong("not of the kind udpm");
    String group = text.substring(scheme.length()).split("\\?", 2)[0];
    String[] parts = group.split(":", 2);
    if (parts.length != 2) throw wrong("an address and a port are needed");
    address = parts[0];
    if (!isMulticast(address)) {
      throw wrong(address + " is not a multicast address (224.0.0.0 to 239.255.255.255)");
    }
    try {
      port = Integer.parseInt(parts[1]);
    } catch (NumberFormatException error) {
      throw wrong("\"" + parts[1] + "\" is no port");
    }
    if (port < 1 || port > 65535) throw wrong("port must be 1 to 65535");
  }

  private static boolean isMulticast(String address) {
    String number = "(0|[1-9][0-9]{0,2})";
    if (!address.matches(number + "(\\." + number + "){3}")) return false;
    String[] parts = address.split("\\.");
    for (String part : parts) {
      if (Integer.parseInt(part) > 255) return false;
    }
    int first = Integer.parseInt(parts[0]);
    return first >= 224 && first <= 239;
  }

  private IllegalArgumentException wrong(String why) {
    return new IllegalArgumentException(
        "LCM URL \"" + text + "\": " + why + "; expected udpm://ADDRESS:PORT?ttl=N");
  }
}
