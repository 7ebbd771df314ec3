package palpate.spy;

import java.awt.Window;
import java.awt.image.BufferedImage;
import java.io.File;
import java.io.IOException;
import java.util.ArrayList;
import java.util.List;
import javax.imageio.ImageIO;
import javax.swing.JFrame;
import javax.swing.SwingUtilities;
import lcm.lcm.LCM;
import lcm.spy.ChannelData;
import lcm.spy.Spy;
import lcm.spy.SpyAccess;
import lcm.spy.SpyPlugin;

/** Stock lcm-spy on several URLs at once, with palpate's types, charts and windows. */
public final class Main {
  private static final long LOOK_MS = 50;
  private static final long LONGEST_WAIT_NS = 60_000_000_000L; // for windows that were requested

  private final Options options;
  private final Spy spy;
  private final List<Receiver> receivers = new ArrayList<>();

  private Main(Options options) throws IOException {
    this.options = options;
    // The spy gets messages from our receivers only: LCM's own stops at the first invalid packet.
    spy = new Spy("memq://");
    LCM lcm = SpyAccess.lcm(spy);
    Feed.set(lcm);
    for (Url url : options.urls) {
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
    System.out.println("listens to " + options.describeUrls());
  }

  /** Opens the requested windows, each as soon as a message on its channel arrives. */
  private void openWindows(long end) throws InterruptedException {
    List<Options.Wish> waiting = new ArrayList<>(options.wishes);
    while (!waiting.isEmpty() && System.nanoTime() < end) {
      waiting.removeIf(this::opened);
      Thread.sleep(LOOK_MS);
    }
    for (Options.Wish wish : waiting) {
      System.err.println("palpate-spy: nothing that " + wish.word + " shows came"
          + (wish.channel == null ? "" : " on " + wish.channel));
    }
  }

  private boolean opened(Options.Wish wish) {
    for (String channel : wish.channels()) {
      ChannelData data = SpyAccess.channel(spy, channel);
      if (data == null) continue;
      for (SpyPlugin plugin : SpyAccess.plugins(spy)) {
        if (!(plugin instanceof PlugIn) || !plugin.canHandle(data.fingerprint)) continue;
        PlugIn ours = (PlugIn) (Object) plugin;
        if (!ours.word().equals(wish.word)) continue;
        SwingUtilities.invokeLater(() -> ours.open(channel));
        System.out.println("opened " + wish.word + " of " + channel);
        return true;
      }
    }
    return false;
  }

  /** One PNG per window, named spy, electrodes, error, mesh. */
  private void takePictures(File folder) throws Exception {
    if (!folder.isDirectory() && !folder.mkdirs()) {
      throw new IOException(folder + ": cannot be made");
    }
    SwingUtilities.invokeAndWait(
        () -> {
          for (Window window : Window.getWindows()) {
            if (!(window instanceof JFrame) || !window.isVisible()) continue;
            JFrame frame = (JFrame) window;
            String name = frame.getName().startsWith("frame") ? "spy" : frame.getName();
            write(frame, new File(folder, name + ".png"));
          }
        });
  }

  private static void write(JFrame frame, File file) {
    BufferedImage image =
        new BufferedImage(frame.getContentPane().getWidth(), frame.getContentPane().getHeight(),
            BufferedImage.TYPE_INT_RGB);
    frame.getContentPane().paint(image.getGraphics());
    try {
      ImageIO.write(image, "png", file);
      System.out.println("wrote " + file);
    } catch (IOException error) {
      System.err.println("palpate-spy: " + file + ": " + error.getMessage());
    }
  }

  private void waitUntilReady(long end) throws InterruptedException {
    while (System.nanoTime() < end) {
      boolean ready = PlugIn.OPEN.values().stream().allMatch(PlugIn.View::isReady);
      if (ready && PlugIn.OPEN.size() >= options.wishes.size()) return;
      Thread.sleep(LOOK_MS);
    }
  }

  private void run() throws Exception {
    boolean ends = options.seconds > 0;
    long end = ends ? System.nanoTime() + LONGEST_WAIT_NS : Long.MAX_VALUE;
    openWindows(end);
    if (!ends) return; // the windows live on
    waitUntilReady(end);
    Thread.sleep((long) (1e3 * options.seconds));
    // For screen readers.
    PlugIn.OPEN.forEach((name, view) -> System.out.println(name + ": " + view.words()));
    if (options.pictures != null) takePictures(new File(options.pictures));
    long refused = 0;
    for (Receiver receiver : receivers) refused += receiver.refused();
    System.out.println("refused " + refused + " datagrams");
    System.exit(0);
  }

  public static void main(String[] arguments) {
    try {
      Options options = Options.parse(arguments);
      if (options.help) {
        System.out.print(Options.HELP);
        return;
      }
      new Main(options).run();
    } catch (IllegalArgumentException | IOException | java.awt.HeadlessException error) {
      System.err.println("palpate-spy: " + error.getMessage());
      System.exit(1);
    } catch (Exception error) {
      error.printStackTrace();
      System.exit(1);
    }
  }
}
