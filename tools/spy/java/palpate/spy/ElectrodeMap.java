package palpate.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.event.MouseAdapter;
import java.awt.event.MouseEvent;
import java.awt.geom.Area;
import java.awt.geom.Ellipse2D;
import java.awt.geom.Path2D;
import java.awt.geom.Rectangle2D;
import java.awt.image.BufferedImage;
import java.io.IOException;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import javax.swing.JComponent;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.SpyPlugin;
import palpate.biotac_t;

/**
 * The nineteen electrodes on the unrolled skin, coloured by the difference of their counts from
 * rest (the first messages; a click tares again), with the other signals of the fingertip.
 */
public final class ElectrodeMap extends PlugIn implements SpyPlugin {
  @Override
  String title() {
    return "Electrode map";
  }

  @Override
  String word() {
    return "electrodes";
  }

  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == biotac_t.LCM_FINGERPRINT;
  }

  @Override
  View view(String channel) {
    return new Panel();
  }

  private static final class Panel extends JComponent implements View {
    private static final int TARE_MESSAGES = 20;
    private static final int HISTORY = 400; // samples of PAC
    private static final double LEAST_RANGE = 20; // counts
    private static final double REACH = 2.4; // mm, of an electrode's colour
    private static final double EDGE = 11.2; // mm around the finger, each way
    private static final int MAP_WIDTH = 460;

    private final ElectrodeLayout layout = new ElectrodeLayout();
    private final double[] rest = new double[ElectrodeLayout.COUNT];
    private final double[] now = new double[ElectrodeLayout.COUNT];
    private final double[] pac = new double[HISTORY];
    private int tared;
    private double range = LEAST_RANGE;
    private biotac_t last;
    private double restPdc;

    Panel() {
      setPreferredSize(new Dimension(720, 460));
      addMouseListener(
          new MouseAdapter() {
            @Override
            public void mouseClicked(MouseEvent event) {
              tare();
            }
          });
    }

    @Override
    public JComponent component() {
      return this;
    }

    @Override
    public List<String> channels() {
      return new ArrayList<>();
    }

    private synchronized void tare() {
      tared = 0;
      range = LEAST_RANGE;
    }

    @Override
    public synchronized void take(String channel, LCMDataInputStream message)
        throws IOException {
      biotac_t sample = new biotac_t(message);
      if (tared < TARE_MESSAGES) {
        ++tared;
        for (int i = 0; i < rest.length; ++i) {
          rest[i] += (sample.electrodes[i] - (tared == 1 ? 0 : rest[i])) / tared;
          if (tared == 1) rest[i] = sample.electrodes[i];
        }
        restPdc = tared == 1 ? sample.pdc : restPdc + (sample.pdc - restPdc) / tared;
      }
      double largest = LEAST_RANGE;
      for (int i = 0; i < now.length; ++i) {
        now[i] = sample.electrodes[i] - rest[i];
        largest = Math.max(largest, Math.abs(now[i]));
      }
      // Rises immediately and falls slowly, so that colours can be compared during a contact.
      range = Math.max(largest, range * 0.998);
      int count = Math.max(0, Math.min(sample.pac_count, sample.pac.length));
      System.arraycopy(pac, count, pac, 0, HISTORY - count);
      for (int i = 0; i < count; ++i) pac[HISTORY - count + i] = sample.pac[i];
      last = sample;
    }

    @Override
    public void redraw() {
      repaint();
    }

    @Override
    protected synchronized void paintComponent(Graphics graphics) {
      Graphics2D g = Palette.smooth(graphics);
      g.setColor(Palette.PAPER);
      g.fillRect(0, 0, getWidth(), getHeight());
      drawMap(g);
      drawSignals(g, MAP_WIDTH + 20, getWidth() - MAP_WIDTH - 40);
      g.dispose();
    }

    @Override
    public synchronized boolean isReady() {
      return last != null;
    }

    @Override
    public synchronized String words() {
      if (last == null) return "waits for a message";
      int most = 0;
      for (int i = 0; i < now.length; ++i) {
        if (Math.abs(now[i]) > Math.abs(now[most])) most = i;
      }
      return String.format("farthest from rest: E%d by %+d counts", most + 1,
          Math.round(now[most]));
    }

    // The finger's tip points to the right: u to the right, v down.
    private double scale() {
      return Math.min(MAP_WIDTH / 27.0, (getHeight() - 90) / 23.0);
    }

    private double x(double u) {
      return 20 + (u + 15.5) * scale();
    }

    private double y(double v) {
      return 20 + (v + EDGE) * scale();
    }

    private Area skin() {
      double s = scale();
      Area area = new Area(new Rectangle2D.Double(x(-15.5), y(-EDGE), 15.5 * s, 2 * EDGE * s));
      area.add(new Area(new Ellipse2D.Double(x(-10), y(-EDGE), 20 * s, 2 * EDGE * s)));
      return area;
    }

    private void drawMap(Graphics2D g) {
      Area skin = skin();
      Rectangle2D bounds = skin.getBounds2D();
      if (last != null) {
        BufferedImage field = field(bounds);
        g.setClip(skin);
        g.setRenderingHint(
            RenderingHints.KEY_INTERPOLATION, RenderingHints.VALUE_INTERPOLATION_BILINEAR);
        g.drawImage(field, (int) bounds.getX(), (int) bounds.getY(), (int) bounds.getWidth(),
            (int) bounds.getHeight(), null);
        g.setClip(null);
      }
      g.setColor(Palette.FAINT);
      g.setStroke(new BasicStroke(1.5f));
      g.draw(skin);
      double radius = 1.25 * scale();
      for (int i = 0; i < now.length; ++i) {
        double cx = x(layout.u[i]);
        double cy = y(layout.v[i]);
        Ellipse2D dot = new Ellipse2D.Double(cx - radius, cy - radius, 2 * radius, 2 * radius);
        Color colour = last == null ? Palette.PAPER : Palette.diverging(now[i] / range);
        g.setColor(colour);
        g.fill(dot);
        g.setColor(Palette.INK);
        g.draw(dot);
        boolean dark = last != null && Math.abs(now[i]) > 0.6 * range;
        g.setColor(dark ? Palette.PAPER : Palette.INK);
        String counts = last == null ? "-" : String.format("%+d", Math.round(now[i]));
        centre(g, Palette.BOLD, counts, cx, cy + 2);
        centre(g, Palette.SMALL, "E" + (i + 1), cx, cy + 13);
      }
      int bottom = (int) bounds.getMaxY() + 18;
      String end = String.format("%.0f", range);
      Palette.drawScale(g, 24, bottom, 220, p -> Palette.diverging(2 * p - 1), "-" + end, "0",
          "+" + end + " counts");
      g.setColor(Palette.INK);
      g.setFont(Palette.SMALL);
      g.drawString(tared < TARE_MESSAGES ? "tares" : "since the tare; a click tares anew", 260,
          bottom + 10);
      g.drawString("tip", (float) x(10) - 16, (float) y(0) + 30);
    }

    /** Counts interpolated between the electrodes, by their distance. */
    private BufferedImage field(Rectangle2D bounds) {
      int width = 92;
      int height = 64;
      BufferedImage image = new BufferedImage(width, height, BufferedImage.TYPE_INT_RGB);
      double s = scale();
      for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
          double px = bounds.getX() + (column + 0.5) * bounds.getWidth() / width;
          double py = bounds.getY() + (row + 0.5) * bounds.getHeight() / height;
          double sum = 0;
          double weights = 1e-3;
          for (int i = 0; i < now.length; ++i) {
            double du = (px - x(layout.u[i])) / s;
            double dv = (py - y(layout.v[i])) / s;
            double weight = Math.exp(-0.5 * (du * du + dv * dv) / (REACH * REACH));
            sum += weight * now[i];
            weights += weight;
          }
          image.setRGB(column, row, Palette.diverging(sum / weights / range).getRGB());
        }
      }
      return image;
    }

    private static void centre(
        Graphics2D g, java.awt.Font font, String text, double x, double y) {
      g.setFont(font);
      g.drawString(text, (float) (x - 0.5 * g.getFontMetrics().stringWidth(text)), (float) y);
    }

    private void drawSignals(Graphics2D g, int left, int width) {
      g.setColor(Palette.INK);
      g.setFont(Palette.TEXT);
      if (last == null) {
        g.drawString("waits for a message", left, 50);
        return;
      }
      String[] lines = {
        String.format("PDC  %d  (%+.0f)", last.pdc, last.pdc - restPdc),
        "TAC  " + last.tac,
        "TDC  " + last.tdc,
        "session  " + Long.toHexString(last.session),
        "message  " + last.seq,
        "valid  " + validity(last.valid)
      };
      int y = 46;
      for (String line : lines) {
        g.drawString(line, left, y);
        y += 20;
      }
      drawPac(g, left, y + 20, width, 120);
    }

    private static String validity(int flags) {
      List<String> names = new ArrayList<>();
      if ((flags & biotac_t.VALID_ELECTRODES) != 0) names.add("electrodes");
      if ((flags & biotac_t.VALID_PAC) != 0) names.add("PAC");
      if ((flags & biotac_t.VALID_PDC) != 0) names.add("PDC");
      if ((flags & biotac_t.VALID_TEMPERATURE) != 0) names.add("T");
      return names.isEmpty() ? "nothing" : String.join(", ", names);
    }

    private void drawPac(Graphics2D g, int left, int top, int width, int height) {
      double low = Arrays.stream(pac).min().getAsDouble();
      double high = Math.max(low + 10, Arrays.stream(pac).max().getAsDouble());
      g.setFont(Palette.SMALL);
      g.drawString(
          String.format("PAC, last %d samples: %.0f to %.0f", HISTORY, low, high), left, top - 6);
      g.setColor(Palette.FAINT);
      g.drawRect(left, top, width, height);
      Path2D line = new Path2D.Double();
      for (int i = 0; i < HISTORY; ++i) {
        double px = left + width * i / (double) (HISTORY - 1);
        double py = top + height * (high - pac[i]) / (high - low);
        if (i == 0) line.moveTo(px, py);
        else line.lineTo(px, py);
      }
      g.setColor(Palette.ESTIMATE);
      g.setStroke(new BasicStroke(1.2f));
      g.draw(line);
    }
  }
}
