package palpate.spy;

import java.awt.Color;
import java.awt.Font;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;

/** Colours and fonts shared by all windows. */
final class Palette {
  static final Color PAPER = Color.WHITE;
  static final Color INK = new Color(0x20, 0x24, 0x2a);
  static final Color FAINT = new Color(0xb8, 0xbe, 0xc6);
  static final Color ESTIMATE = new Color(0x1f, 0x5f, 0xb4);
  static final Color TRUTH = new Color(0xc4, 0x7f, 0x17);
  static final Color FORCE = new Color(0xb0, 0x1c, 0x2e);
  static final Font TEXT = new Font(Font.SANS_SERIF, Font.PLAIN, 12);
  static final Font SMALL = new Font(Font.SANS_SERIF, Font.PLAIN, 10);
  static final Font BOLD = new Font(Font.SANS_SERIF, Font.BOLD, 12);

  // Blue below, white at zero, red above: distinguishable with colour blindness as well.
  private static final float[][] DIVERGING = {
    {0.02f, 0.19f, 0.38f}, {0.26f, 0.58f, 0.76f}, {0.97f, 0.97f, 0.97f},
    {0.84f, 0.38f, 0.30f}, {0.40f, 0.00f, 0.12f}
  };
  // Dark blue to yellow.
  private static final float[][] RISING = {
    {0.27f, 0.00f, 0.33f}, {0.23f, 0.32f, 0.55f}, {0.13f, 0.57f, 0.55f},
    {0.37f, 0.79f, 0.38f}, {0.99f, 0.91f, 0.14f}
  };

  private Palette() {}

  /** `value` from -1 to 1; clamped. */
  static Color diverging(double value) {
    return between(DIVERGING, 0.5 * (value + 1));
  }

  /** `value` from 0 to 1; clamped. */
  static Color rising(double value) {
    return between(RISING, value);
  }

  private static Color between(float[][] stops, double place) {
    double clamped = Double.isFinite(place) ? Math.max(0, Math.min(1, place)) : 0;
    double at = clamped * (stops.length - 1);
    int low = Math.min((int) at, stops.length - 2);
    float part = (float) (at - low);
    float[] mixed = new float[3];
    for (int i = 0; i < 3; ++i) {
      mixed[i] = (1 - part) * stops[low][i] + part * stops[low + 1][i];
    }
    return new Color(mixed[0], mixed[1], mixed[2]);
  }

  static Graphics2D smooth(Graphics graphics) {
    Graphics2D g = (Graphics2D) graphics.create();
    g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
    g.setRenderingHint(
        RenderingHints.KEY_TEXT_ANTIALIASING, RenderingHints.VALUE_TEXT_ANTIALIAS_ON);
    g.setRenderingHint(RenderingHints.KEY_STROKE_CONTROL, RenderingHints.VALUE_STROKE_PURE);
    return g;
  }

  /** A colour bar with labels at its ends and its middle. */
  interface Scale {
    Color at(double part);
  }

  static void drawScale(
      Graphics2D g, int x, int y, int width, Scale scale, String low, String middle, String high) {
    for (int i = 0; i < width; ++i) {
      g.setColor(scale.at(i / (double) (width - 1)));
      g.fillRect(x + i, y, 1, 10);
    }
    g.setColor(INK);
    g.setFont(SMALL);
    g.drawRect(x, y, width, 10);
    g.drawString(low, x, y + 22);
    g.drawString(middle, x + (width - g.getFontMetrics().stringWidth(middle)) / 2, y + 22);
    g.drawString(high, x + width - g.getFontMetrics().stringWidth(high), y + 22);
  }
}
