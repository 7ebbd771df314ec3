package palpate.spy;

import lcm.lcm.LCM;

/**
 * Source of messages for plug-ins: palpate-spy's receivers, or, within stock lcm-spy, LCM's own.
 */
final class Feed {
  private static LCM lcm;

  private Feed() {}

  static synchronized void set(LCM source) {
    lcm = source;
  }

  static synchronized LCM lcm() {
    if (lcm == null) lcm = LCM.getSingleton();
    return lcm;
  }
}
