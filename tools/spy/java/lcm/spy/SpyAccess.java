package lcm.spy;

import java.util.ArrayList;
import java.util.List;
import java.util.TreeMap;
import lcm.lcm.LCM;

/** Package-private parts of the stock window: its LCM and its channels. */
public final class SpyAccess {
  private SpyAccess() {}

  public static LCM lcm(Spy spy) {
    return spy.lcm;
  }

  /** "CHANNEL: type, N messages" of each channel, in alphabetical order. Lock the spy's LCM. */
  public static List<String> describeChannels(Spy spy) {
    List<String> lines = new ArrayList<>();
    for (ChannelData data : new TreeMap<>(spy.channelMap).values()) {
      String type = data.cls == null ? "unknown type" : data.cls.getName();
      lines.add(data.name + ": " + type + ", " + data.nreceived + " messages");
    }
    return lines;
  }
}
