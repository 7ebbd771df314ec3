package palpate.spy;

import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;

/** palpate-spy's command line. */
final class Options {
  static final String HELP =
      "lcm-spy with palpate's message types, on control, housekeeping and pictures at once.\n"
          + "A double click on a channel shows its fields, a click on a number its chart.\n"
          + "Shapes, their error, forces and electrodes: palpate-view.\n"
          + "Usage: palpate-spy [OPTIONS]\n\n"
          + "Options:\n"
          + "  -h,--help                   Print this help message and exit\n"
          + "  --version                   Display program version information and exit\n"
          + "  --url TEXT ...              listen there (repeatable) in place of the default three:\n"
          + "                              udpm://239.255.76.67:7667 to udpm://239.255.76.69:7669\n"
          + "  --seconds FLOAT             end after this time and print the channels with their types\n"
          + "                              and numbers of messages; default: when the window is closed\n\n"
          + "Example:\n"
          + "  palpate-spy --url udpm://239.255.76.67:7667\n"
          + "Exit codes: 0 ended, 1 an error.\n";

  private static final String[] DEFAULT_URLS = {"udpm://239.255.76.67:7667",
      "udpm://239.255.76.68:7668", "udpm://239.255.76.69:7669"};

  final List<Url> urls = new ArrayList<>();
  double seconds; // 0: until the window is closed
  boolean help;

  /** Throws IllegalArgumentException naming the option. */
  static Options parse(String[] arguments) {
    Options options = new Options();
    for (int i = 0; i < arguments.length; ++i) {
      String[] parts = arguments[i].split("=", 2);
      String name = parts[0];
      if (name.equals("--help") || name.equals("-h")) {
        options.help = true;
        continue;
      }
      if (!Arrays.asList("--url", "-l", "--lcm-url", "--seconds").contains(name)) {
        throw new IllegalArgumentException(arguments[i] + " is unknown; see --help");
      }
      if (parts.length == 1 && i + 1 == arguments.length) {
        throw new IllegalArgumentException(name + " needs a value; see --help");
      }
      String value = parts.length == 2 ? parts[1] : arguments[++i];
      if (name.equals("--seconds")) options.seconds = number(name, value);
      else options.urls.add(new Url(value));
    }
    if (options.urls.isEmpty()) {
      for (String url : DEFAULT_URLS) options.urls.add(new Url(url));
    }
    return options;
  }

  private static double number(String name, String value) {
    try {
      double number = Double.parseDouble(value);
      if (number > 0 && number < 1e9) return number;
    } catch (NumberFormatException error) {
      // Reported below.
    }
    throw new IllegalArgumentException(name + " " + value + ": must be a number above zero");
  }
}
