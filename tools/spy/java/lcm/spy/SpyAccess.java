package lcm.spy;

import java.util.ArrayList;
import java.util.List;
import javax.swing.JTable;
import lcm.lcm.LCM;

/** What the stock window keeps to its own package: its LCM, its channels, its plug-ins, its table. */
public final class SpyAccess {
  private SpyAccess() {}

  public static LCM lcm(Spy spy) {
    return spy.lcm;
  }

  public static List<SpyPlugin> plugins(Spy spy) {
    return new ArrayList<>(spy.plugins);
  }

  /** Null where nothing has come on the channel. The spy's receiver holds its LCM's lock. */
  public static ChannelData channel(Spy spy, String name) {
    return spy.channelMap.get(name);
  }

  public static JTable table(Spy spy) {
    return spy.channelTable;
  }
}
