package lcm.spy;

import java.util.ArrayList;
import java.util.List;
import javax.swing.JTable;
import lcm.lcm.LCM;

/** Package-private parts of the stock window: its LCM, its channels, its plug-ins, its table. */
public final class SpyAccess {
  private SpyAccess() {}

  public static LCM lcm(Spy spy) {
    return spy.lcm;
  }

  public static List<SpyPlugin> plugins(Spy spy) {
    return new ArrayList<>(spy.plugins);
  }

  /**
   * Null if nothing has been received on the channel. Requires the lock of its LCM, held by the
   * spy's receiver.
   */
  public static ChannelData channel(Spy spy, String name) {
    return spy.channelMap.get(name);
  }

  public static JTable table(Spy spy) {
    return spy.channelTable;
  }
}
