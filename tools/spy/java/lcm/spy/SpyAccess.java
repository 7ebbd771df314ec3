package lcm.spy;

import java.util.ArrayList;
import java.util.List;
import java.util.TreeMap;
import lcm.lcm.LCM;
import palpate.Channels;

/** Package-private parts of the stock window: its LCM and its channels. */
public final class SpyAccess {
  private SpyAccess() {}

  public static LCM lcm(Spy spy) {
    return spy.lcm;
  }

  /**
   * "CHANNEL: type, N messages" of each channel, in alphabetical order, with a remark where the
   * table of channels says otherwise. Lock the spy's LCM.
   */
  public static List<String> describeChannels(Spy spy) {
    List<String> lines = new ArrayList<>();
    for (ChannelData data : new TreeMap<>(spy.channelMap).values()) {
      String type = data.cls == null ? "unknown type" : data.cls.getName();
      lines.add(data.name + ": " + type + ", " + data.nreceived + " messages" + remark(data));
    }
    return lines;
  }

  private static String remark(ChannelData data) {
    Channels.Channel known = Channels.find(data.name);
    if (known == null) return ", not a channel of palpate";
    boolean fits = data.cls != null && data.cls.getName().equals("palpate." + known.type);
    return fits ? "" : ", expected palpate." + known.type;
  }
}
