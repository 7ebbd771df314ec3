package palpate.spy;

import java.awt.event.ActionEvent;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.io.IOException;
import java.util.ArrayList;
import java.util.List;
import java.util.Map;
import java.util.concurrent.ConcurrentSkipListMap;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JComponent;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.SwingUtilities;
import javax.swing.Timer;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import lcm.spy.ChannelData;

/**
 * A window for one channel, opened from the spy's menu. Subclasses themselves declare that they are
 * plug-ins: the spy checks the class itself, and creates one of each.
 */
abstract class PlugIn {
  /** The open windows, by their names. */
  static final Map<String, View> OPEN = new ConcurrentSkipListMap<>();

  private static final int REDRAW_MS = 50;

  /** Content of a window. Messages arrive in the receiver's thread, redraw() runs in Swing's. */
  interface View {
    JComponent component();

    /** Channels that the view receives in addition to its own. */
    List<String> channels();

    void take(String channel, LCMDataInputStream message) throws IOException;

    void redraw();

    /** Whether it has received everything that it needs to show something. */
    boolean isReady();

    /** Its content, in one line. */
    String words();
  }

  /** Name in the spy's menu and the window's title. */
  abstract String title();

  /** One word for the command line. */
  abstract String word();

  abstract View view(String channel);

  /** As the spy calls it. */
  public Action getAction(JDesktopPane desktop, ChannelData channel) {
    return new AbstractAction(title()) {
      @Override
      public void actionPerformed(ActionEvent event) {
        open(channel.name);
      }
    };
  }

  @Override
  public String toString() {
    return title();
  }

  JFrame open(String channel) {
    View view = view(channel);
    JFrame frame = new JFrame(title() + ": " + channel);
    String name = OPEN.containsKey(word()) ? word() + "-" + channel : word();
    frame.setName(name);
    frame.add(view.component());
    frame.pack();
    frame.setLocationByPlatform(true);
    List<String> channels = new ArrayList<>(view.channels());
    channels.add(channel);
    LCMSubscriber subscriber = new Guard(view);
    for (String one : channels) Feed.lcm().subscribe(one, subscriber);
    Timer timer = new Timer(REDRAW_MS, event -> view.redraw());
    timer.start();
    frame.addWindowListener(
        new WindowAdapter() {
          @Override
          public void windowClosing(WindowEvent event) {
            timer.stop();
            for (String one : channels) Feed.lcm().unsubscribe(one, subscriber);
            OPEN.remove(name);
            frame.dispose();
          }
        });
    frame.setVisible(true);
    OPEN.put(name, view);
    return frame;
  }

  /** The receiver continues for any bytes. */
  private static final class Guard implements LCMSubscriber {
    private final View view;

    Guard(View view) {
      this.view = view;
    }

    @Override
    public void messageReceived(LCM lcm, String channel, LCMDataInputStream message) {
      try {
        view.take(channel, message);
      } catch (IOException | RuntimeException | OutOfMemoryError error) {
        // Of another type or malformed; the spy's own table counts it.
      }
    }
  }
}
