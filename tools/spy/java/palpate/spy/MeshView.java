package palpate.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.event.MouseAdapter;
import java.awt.event.MouseEvent;
import java.awt.geom.Line2D;
import java.awt.geom.Path2D;
import java.io.IOException;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import javax.swing.JComponent;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.SpyPlugin;
import palpate.contacts_t;
import palpate.shape_mesh_t;
import palpate.shape_t;

/**
 * The object seen along an axis of its frame, initially from above: surface coloured by its
 * displacement from rest, the nodes of the simulator's ground truth as points if available, contact
 * forces as arrows. A click selects the next view.
 */
public final class MeshView extends PlugIn implements SpyPlugin {
  @Override
  String title() {
    return "Mesh, top view";
  }

  @Override
  String word() {
    return "mesh";
  }

  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == shape_t.LCM_FINGERPRINT
        || fingerprint == shape_mesh_t.LCM_FINGERPRINT;
  }

  @Override
  View view(String channel) {
    return new Panel(channel);
  }

  private static final class Panel extends JComponent implements View {
    private static final String[] VIEWS = {"from above, x right, y up",
        "from the side, x right, z up", "along x, y right, z up"};
    private static final int[][] AXES = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}}; // right, up, depth
    private static final double[] TOWARDS = {1, -1, 1}; // the viewer, along depth
    private static final double METRES_A_NEWTON = 0.03;
    private static final int MARGIN = 46;

    private final String channel;
    private final String suffix;
    private final Mesh.Builder chunks = new Mesh.Builder();
    private Mesh mesh;
    private shape_t shape;
    private shape_t truth;
    private contacts_t contacts;
    private int view;
    private double[] window; // least right, most right, least up, most up, m

    Panel(String channel) {
      this.channel = channel;
      boolean true_ = channel.startsWith("TRUTH_");
      String plain = (true_ ? channel.substring("TRUTH_".length()) : channel);
      suffix = plain.replaceFirst("^SHAPE(_MESH)?", "").replaceFirst("^MESH", "");
      setPreferredSize(new Dimension(760, 460));
      addMouseListener(
          new MouseAdapter() {
            @Override
            public void mouseClicked(MouseEvent event) {
              nextView();
            }
          });
    }

    private synchronized void nextView() {
      view = (view + 1) % VIEWS.length;
      window = null;
    }

    private boolean showsTruth() {
      return channel.startsWith("TRUTH_");
    }

    private String meshChannel() {
      return (showsTruth() ? "TRUTH_MESH" : "SHAPE_MESH") + suffix;
    }

    private String shapeChannel() {
      return (showsTruth() ? "TRUTH_SHAPE" : "SHAPE") + suffix;
    }

    @Override
    public JComponent component() {
      return this;
    }

    @Override
    public List<String> channels() {
      List<String> channels = new ArrayList<>(Arrays.asList(
          meshChannel(), shapeChannel(), "CONTACTS" + suffix));
      if (!showsTruth()) channels.add("TRUTH_SHAPE" + suffix);
      channels.remove(channel);
      return channels;
    }

    @Override
    public synchronized void take(String from, LCMDataInputStream message) throws IOException {
      if (from.equals(meshChannel())) {
        Mesh made = chunks.add(new shape_mesh_t(message));
        if (made == null) return;
        mesh = made;
        window = null;
      } else if (from.equals(shapeChannel())) {
        shape = new shape_t(message);
      } else if (from.equals("TRUTH_SHAPE" + suffix)) {
        truth = new shape_t(message);
      } else if (from.equals("CONTACTS" + suffix)) {
        contacts = new contacts_t(message);
      }
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
      g.setColor(Palette.INK);
      g.setFont(Palette.TEXT);
      if (!isKnown()) {
        g.drawString(words(), 20, 30);
      } else {
        fit();
        drawGrid(g);
        drawSurface(g);
        drawTruth(g);
        drawContacts(g);
        drawWords(g);
      }
      g.dispose();
    }

    /** Grows the window to contain the shape; it never shrinks, so that the image stays steady. */
    private void fit() {
      int[] axes = AXES[view];
      if (window == null) window = new double[] {1e9, -1e9, 1e9, -1e9};
      for (float[] xyz : new float[][] {mesh.rest, shape.xyz}) {
        for (int i = 0; i < xyz.length; i += 3) {
          double right = xyz[i + axes[0]];
          double up = xyz[i + axes[1]];
          if (!Double.isFinite(right) || !Double.isFinite(up)) continue;
          window[0] = Math.min(window[0], right);
          window[1] = Math.max(window[1], right);
          window[2] = Math.min(window[2], up);
          window[3] = Math.max(window[3], up);
        }
      }
    }

    private double scale() {
      double wide = Math.max(1e-3, window[1] - window[0]);
      double high = Math.max(1e-3, window[3] - window[2]);
      return Math.min((getWidth() - 2 * MARGIN) / wide, (getHeight() - 2 * MARGIN - 40) / high);
    }

    private double px(double right) {
      return getWidth() / 2.0 + (right - 0.5 * (window[0] + window[1])) * scale();
    }

    private double py(double up) {
      return (getHeight() - 30) / 2.0 - (up - 0.5 * (window[2] + window[3])) * scale();
    }

    private double px(float[] xyz, int node) {
      return px(xyz[3 * node + AXES[view][0]]);
    }

    private double py(float[] xyz, int node) {
      return py(xyz[3 * node + AXES[view][1]]);
    }

    /** Lines that are 10, 50 or 100 mm apart. */
    private void drawGrid(Graphics2D g) {
      double step = 0.01;
      if (scale() * step < 25) step = 0.05;
      if (scale() * step < 25) step = 0.1;
      g.setFont(Palette.SMALL);
      double width = getWidth() / scale();
      double middle = 0.5 * (window[0] + window[1]);
      for (double at = Math.ceil((middle - width / 2) / step) * step; at < middle + width / 2;
          at += step) {
        g.setColor(new Color(0xee, 0xf0, 0xf2));
        g.draw(new Line2D.Double(px(at), 0, px(at), getHeight() - 52));
        g.setColor(Palette.FAINT);
        g.drawString(Math.round(1e3 * at) + "", (float) px(at) + 2, getHeight() - 56);
      }
      double height = getHeight() / scale();
      middle = 0.5 * (window[2] + window[3]);
      for (double at = Math.ceil((middle - height / 2) / step) * step; at < middle + height / 2;
          at += step) {
        if (py(at) > getHeight() - 66) continue;
        g.setColor(new Color(0xee, 0xf0, 0xf2));
        g.draw(new Line2D.Double(0, py(at), getWidth(), py(at)));
        g.setColor(Palette.FAINT);
        g.drawString(Math.round(1e3 * at) + "", 4, (float) py(at) - 2);
      }
    }

    private double largestDisplacement() {
      double most = 1e-4;
      for (int i = 0; i < mesh.nodeCount(); ++i) most = Math.max(most, displacement(i));
      return most;
    }

    private double displacement(int node) {
      double square = 0;
      for (int axis = 0; axis < 3; ++axis) {
        double off = shape.xyz[3 * node + axis] - mesh.rest[3 * node + axis];
        square += off * off;
      }
      return Math.sqrt(square);
    }

    /** Far triangles first (painter's algorithm). */
    private Integer[] order() {
      int count = mesh.triangles.length / 3;
      double[] depth = new double[count];
      Integer[] order = new Integer[count];
      for (int t = 0; t < count; ++t) {
        order[t] = t;
        for (int i = 0; i < 3; ++i) {
          int node = mesh.triangles[3 * t + i];
          depth[t] += TOWARDS[view] * shape.xyz[3 * node + AXES[view][2]];
        }
      }
      Arrays.sort(order, (a, b) -> Double.compare(depth[a], depth[b]));
      return order;
    }

    private void drawSurface(Graphics2D g) {
      double most = largestDisplacement();
      g.setStroke(new BasicStroke(0.6f));
      for (int t : order()) {
        Path2D triangle = new Path2D.Double();
        double mean = 0;
        for (int i = 0; i < 3; ++i) {
          int node = mesh.triangles[3 * t + i];
          mean += displacement(node) / 3;
          if (i == 0) triangle.moveTo(px(shape.xyz, node), py(shape.xyz, node));
          else triangle.lineTo(px(shape.xyz, node), py(shape.xyz, node));
        }
        triangle.closePath();
        g.setColor(Palette.rising(mean / most));
        g.fill(triangle);
        g.setColor(new Color(255, 255, 255, 110));
        g.draw(triangle);
      }
      g.setColor(Palette.INK);
      for (int node : mesh.constrained) {
        double x = px(shape.xyz, node);
        double y = py(shape.xyz, node);
        g.fill(new java.awt.geom.Rectangle2D.Double(x - 1.5, y - 1.5, 3, 3));
      }
      Palette.drawScale(g, 20, getHeight() - 40, 200, Palette::rising, "0",
          "displacement", String.format("%.1f mm", 1e3 * most));
    }

    private void drawTruth(Graphics2D g) {
      if (truth == null) return;
      g.setColor(new Color(0xc4, 0x7f, 0x17, 0xa0));
      for (int i = 0; i < truth.xyz_count / 3; ++i) {
        double x = px(truth.xyz, i);
        double y = py(truth.xyz, i);
        g.fill(new java.awt.geom.Ellipse2D.Double(x - 1.3, y - 1.3, 2.6, 2.6));
      }
    }

    private void drawContacts(Graphics2D g) {
      if (contacts == null) return;
      g.setColor(Palette.FORCE);
      g.setStroke(new BasicStroke(2f));
      int count = Math.max(0, Math.min(contacts.count, contacts.location.length));
      for (int i = 0; i < count; ++i) {
        double x = px(contacts.location[i][AXES[view][0]]);
        double y = py(contacts.location[i][AXES[view][1]]);
        double dx = contacts.wrench[i][AXES[view][0]] * METRES_A_NEWTON * scale();
        double dy = -contacts.wrench[i][AXES[view][1]] * METRES_A_NEWTON * scale();
        g.fill(new java.awt.geom.Ellipse2D.Double(x - 3, y - 3, 6, 6));
        g.draw(new Line2D.Double(x, y, x + dx, y + dy));
        double length = Math.hypot(dx, dy);
        if (length < 8) continue;
        for (int side = -1; side <= 1; side += 2) {
          double ax = -0.9 * dx + side * 0.4 * dy;
          double ay = -0.9 * dy - side * 0.4 * dx;
          g.draw(new Line2D.Double(x + dx, y + dy, x + dx + 8 * ax / length,
              y + dy + 8 * ay / length));
        }
      }
    }

    private boolean isKnown() {
      return mesh != null && shape != null && shape.mesh_hash == mesh.hash
          && shape.xyz_count == mesh.rest.length;
    }

    @Override
    public synchronized boolean isReady() {
      return isKnown();
    }

    @Override
    public synchronized String words() {
      if (!isKnown()) return "waits for " + meshChannel() + " and " + shapeChannel();
      String[] states = {"current", "old", "not converged"};
      String state = shape.status >= 0 && shape.status < states.length ? states[shape.status]
          : "status " + shape.status;
      StringBuilder line = new StringBuilder();
      line.append(String.format("%d nodes, %s, %.1f ms old", mesh.nodeCount(), state,
          1e-3 * shape.age_us));
      if (truth != null) line.append("; points: the simulator's truth");
      if (contacts != null) {
        line.append(String.format("; arrows: contacts, %.0f mm a newton", 1e3 * METRES_A_NEWTON));
      }
      return line.toString();
    }

    private void drawWords(Graphics2D g) {
      g.setFont(Palette.TEXT);
      g.setColor(Palette.INK);
      g.drawString(VIEWS[view] + " (mm; a click turns)", 250, getHeight() - 32);
      g.setFont(Palette.SMALL);
      g.drawString(words(), 250, getHeight() - 16);
    }
  }
}
