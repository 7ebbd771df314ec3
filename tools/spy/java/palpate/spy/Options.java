package palpate.spy;

import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;

/** palpate-spy's command line. */
final class Options {
  static final String HELP =
      "lcm-spy with palpate's message types, charts and windows, on control, housekeeping\n"
          + "and pictures at once. A double click on a channel shows its fields (click a number\n"
          + "for its chart), a right click offers the windows below.\n"
          + "Usage: palpate-spy [OPTIONS]\n\n"
          + "Options:\n"
          + "  -h,--help                   Print this help message and exit\n"
          + "  --version                   Display program version information and exit\n"
          + "  --url TEXT ...              listen there (repeatable) in place of the default three:\n"
          + "                              udpm://239.255.76.67:7667 to udpm://239.255.76.69:7669\n"
          + "  --open TEXT ...             open a window once its channel is heard (repeatable):\n"
          + "                              electrodes, the 19 of a fingertip (BIOTAC_0); error, SHAPE\n"
          + "                              against TRUTH_SHAPE over time; mesh, the object from above;\n"
          + "                              WHAT=CHANNEL names another channel: electrodes=BIOTAC_3\n"
          + "  --seconds FLOAT             end so long after the windows that --open names show something\n"
          + "                              (a minute at most), and print what they show; default: when\n"
          + "                              the window is closed\n"
          + "  --pictures TEXT             with --seconds: folder for a PNG of every window at the end\n\n"
          + "Examples:\n"
          + "  palpate-spy --open mesh --open error\n"
          + "  palpate-spy --url udpm://239.255.76.67:7667 --open electrodes=BIOTAC_2\n"
          + "Exit codes: 0 ended, 1 an error.\n";

  private static final String[] DEFAULT_URLS = {"udpm://239.255.76.67:7667",
      "udpm://239.255.76.68:7668", "udpm://239.255.76.69:7669"};

  /** A window to open. */
  static final class Wish {
    final String word;
    final String channel; // null: the default ones

    Wish(String text) {
      String[] parts = text.split("=", 2);
      word = parts[0];
      channel = parts.length == 2 ? parts[1] : null;
      if (!Arrays.asList("electrodes", "error", "mesh").contains(word)) {
        throw new IllegalArgumentException(
            "--open " + text + ": must be electrodes, error or mesh");
      }
    }

    List<String> channels() {
      if (channel != null) return Arrays.asList(channel);
      if (!word.equals("electrodes")) return Arrays.asList("SHAPE");
      return Arrays.asList("BIOTAC_0", "BIOTAC_1", "BIOTAC_2", "BIOTAC_3", "BIOTAC_4");
    }
  }

  final List<Url> urls = new ArrayList<>();
  final List<Wish> wishes = new ArrayList<>();
  double seconds;
  String pictures;
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
      boolean known = Arrays.asList("--url", "-l", "--lcm-url", "--open", "--seconds",
          "--pictures").contains(name);
      if (!known) throw new IllegalArgumentException(arguments[i] + " is unknown; see --help");
      if (parts.length == 1 && i + 1 == arguments.length) {
        throw new IllegalArgumentException(name + " needs a value; see --help");
      }
      options.take(name, parts.length == 2 ? parts[1] : arguments[++i]);
    }
    if (options.urls.isEmpty()) {
      for (String url : DEFAULT_URLS) options.urls.add(new Url(url));
    }
    if (options.pictures != null && options.seconds <= 0) {
      throw new IllegalArgumentException("--pictures needs --seconds");
    }
    return options;
  }

  private void take(String name, String value) {
    switch (name) {
      case "--open":
        wishes.add(new Wish(value));
        break;
      case "--pictures":
        pictures = value;
        break;
      case "--seconds":
        seconds = number(name, value);
        break;
      default:
        urls.add(new Url(value));
    }
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

  String describeUrls() {
    List<String> texts = new ArrayList<>();
    for (Url url : urls) texts.add(url.text);
    return String.join(", ", texts);
  }
}
