package palpate.spy;

import java.io.IOException;
import java.util.ArrayList;
import java.util.List;
import lcm.lcm.LCM;
import lcm.spy.Spy;
import lcm.spy.SpyAccess;

/** Stock lcm-spy on several URLs at once, with palpate's types. */
public final class Main {
  private Main() {}

  /** Starts receivers of all URLs, which pass their messages to `lcm`. */
  private static List<Receiver> listen(List<Url> urls, LCM lcm) throws IOException {
    List<Receiver> receivers = new ArrayList<>();
    List<String> texts = new ArrayList<>();
    for (Url url : urls) {
      texts.add(url.text);
      try {
        receivers.add(new Receiver(url, lcm));
      } catch (IOException error) {
        throw new IOException(
            "cannot listen to " + url.text + ": " + error.getMessage()
                + ". Is there a route for multicast? For one machine alone:\n"
                + "  ip link set lo multicast on\n  ip route add 224.0.0.0/4 dev lo");
      }
    }
    for (Receiver receiver : receivers) receiver.start();
    System.out.println("listens to " + String.join(", ", texts));
    return receivers;
  }

  private static void run(Options options) throws IOException, InterruptedException {
    // The spy gets messages from our receivers only: LCM's own stops at the first invalid packet.
    Spy spy = new Spy("memq://");
    LCM lcm = SpyAccess.lcm(spy);
    List<Receiver> receivers = listen(options.urls, lcm);
    if (options.seconds <= 0) return; // the window lives on
    Thread.sleep((long) (1e3 * options.seconds));
    synchronized (lcm) {
      for (String line : SpyAccess.describeChannels(spy)) System.out.println(line);
    }
    long rejected = 0;
    for (Receiver receiver : receivers) rejected += receiver.rejected();
    System.out.println("rejected " + rejected + " datagrams");
    System.exit(0);
  }

  public static void main(String[] arguments) {
    try {
      Options options = Options.parse(arguments);
      if (options.help) System.out.print(Options.HELP);
      else run(options);
    } catch (IllegalArgumentException | IOException | java.awt.HeadlessException error) {
      System.err.println("palpate-spy: " + error.getMessage());
      System.exit(1);
    } catch (Exception error) {
      error.printStackTrace();
      System.exit(1);
    }
  }
}
