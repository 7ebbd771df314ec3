package palpate.spy;

import info.monitorenter.gui.chart.Chart2D;
import info.monitorenter.gui.chart.IAxis;
import info.monitorenter.gui.chart.rangepolicies.RangePolicyMinimumViewport;
import info.monitorenter.gui.chart.traces.Trace2DLtd;
import info.monitorenter.util.Range;
import java.awt.BasicStroke;
import java.awt.BorderLayout;
import java.awt.Color;
import java.awt.Dimension;
import java.io.IOException;
import java.util.ArrayDeque;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import javax.swing.BorderFactory;
import javax.swing.JComponent;
import javax.swing.JLabel;
import javax.swing.JPanel;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.SpyPlugin;
import palpate.shape_mesh_t;
import palpate.shape_t;

/**
 * Distance of the nodes of SHAPE from the true positions of their material by TRUTH_SHAPE, over
 * time. Both meshes must have been received; ground truth is published only by a simulator.
 */
public final class ShapeError extends PlugIn implements SpyPlugin {
  @Override
  String title() {
    return "Shape error";
  }

  @Override
  String word() {
    return "error";
  }

  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == shape_t.LCM_FINGERPRINT;
  }

  @Override
  View view(String channel) {
    return new Panel(channel);
  }

  private static final class Panel extends JPanel implements View {
    private static final int POINTS = 6000; // a minute of shapes
    private static final int LONGEST_QUEUE = 64;
    private static final long SAME_CLOCK_US = 300_000;

    private final String suffix;
    private final Trace2DLtd mean = new Trace2DLtd(POINTS, "mean");
    private final Trace2DLtd rms = new Trace2DLtd(POINTS, "RMS");
    private final Trace2DLtd maximum = new Trace2DLtd(POINTS, "largest");
    private final JLabel words = new JLabel();
    private final Mesh.Builder shapeChunks = new Mesh.Builder();
    private final Mesh.Builder truthChunks = new Mesh.Builder();
    private final ArrayDeque<shape_t> waiting = new ArrayDeque<>();
    private final List<double[]> scored = new ArrayList<>();
    private Mesh shapeMesh;
    private Mesh truthMesh;
    private MaterialPoints points;
    private shape_t before; // the second to last truth
    private shape_t after; // the last truth
    private long first;
    private boolean byArrival;
    private String state = "";
    private double[] latest;

    /** A second arm's channels have the same suffix. */
    Panel(String channel) {
      super(new BorderLayout());
      String plain = channel.replaceFirst("^(TRUTH_)?SHAPE", "");
      suffix = plain.equals(channel) ? "" : plain;
      add(chart(), BorderLayout.CENTER);
      words.setFont(Palette.TEXT);
      words.setBorder(BorderFactory.createEmptyBorder(6, 10, 6, 10));
      add(words, BorderLayout.SOUTH);
      setPreferredSize(new Dimension(760, 420));
    }

    private Chart2D chart() {
      Chart2D chart = new Chart2D();
      chart.setBackground(Palette.PAPER);
      chart.setGridColor(new Color(0xe4, 0xe7, 0xea));
      add(chart, maximum, Palette.FORCE, 1.2f);
      add(chart, rms, Palette.TRUTH, 1.6f);
      add(chart, mean, Palette.ESTIMATE, 2.2f);
      IAxis x = chart.getAxisX();
      IAxis y = chart.getAxisY();
      x.setAxisTitle(new IAxis.AxisTitle("s"));
      y.setAxisTitle(new IAxis.AxisTitle("mm"));
      y.setRangePolicy(new RangePolicyMinimumViewport(new Range(0, 0.5))); // from zero
      x.setPaintGrid(true);
      y.setPaintGrid(true);
      return chart;
    }

    private static void add(Chart2D chart, Trace2DLtd trace, Color colour, float width) {
      chart.addTrace(trace);
      trace.setColor(colour);
      trace.setStroke(new BasicStroke(width));
      }

    @Override
    public JComponent component() {
      return this;
    }

    @Override
    public List<String> channels() {
      List<String> channels = new ArrayList<>();
      for (String name : new String[] {"SHAPE", "SHAPE_MESH", "TRUTH_SHAPE", "TRUTH_MESH"}) {
        channels.add(name + suffix);
      }
      return channels;
    }

    @Override
    public synchronized void take(String channel, LCMDataInputStream message)
        throws IOException {
      if (channel.equals("SHAPE_MESH" + suffix)) {
        takeMesh(shapeChunks.add(new shape_mesh_t(message)), null);
      } else if (channel.equals("TRUTH_MESH" + suffix)) {
        takeMesh(null, truthChunks.add(new shape_mesh_t(message)));
      } else if (channel.equals("TRUTH_SHAPE" + suffix)) {
        takeTruth(new shape_t(message));
      } else if (channel.equals("SHAPE" + suffix)) {
        takeShape(new shape_t(message));
      }
    }

    private void takeMesh(Mesh shape, Mesh truth) {
      if (shape == null && truth == null) return;
      if (shape != null) shapeMesh = shape;
      if (truth != null) truthMesh = truth;
      points = null;
      if (shapeMesh == null || truthMesh == null) return;
      try {
        points = new MaterialPoints(truthMesh, shapeMesh.rest);
      } catch (IllegalArgumentException error) {
        state = error.getMessage();
      }
    }

    private void takeShape(shape_t shape) {
      // The channel is received twice if it is the window's own.
      if (!waiting.isEmpty() && waiting.getLast().seq == shape.seq) return;
      waiting.add(shape);
      if (waiting.size() > LONGEST_QUEUE) waiting.removeFirst();
    }

    private void takeTruth(shape_t truth) {
      if (after != null && truth.seq == after.seq && truth.session == after.session) return;
      boolean goesOn = after != null && after.session == truth.session
          && after.utime < truth.utime && after.xyz_count == truth.xyz_count;
      before = goesOn ? after : null;
      after = truth;
      if (before == null || points == null || shapeMesh == null) return;
      if (truthMesh.hash != truth.mesh_hash || truth.xyz_count != truthMesh.rest.length) return;
      if (waiting.isEmpty()) return;
      // A simulator slower than real time has a separate clock.
      long apart = waiting.getLast().utime - after.utime;
      byArrival = Math.abs(apart) > SAME_CLOCK_US;
      if (byArrival) {
        shape_t shape = waiting.getLast();
        waiting.clear();
        if (isKnown(shape)) score(shape, 1);
        return;
      }
      while (!waiting.isEmpty() && waiting.getFirst().utime <= after.utime) {
        shape_t shape = waiting.removeFirst();
        if (!isKnown(shape) || shape.utime < before.utime) continue;
        score(shape, (shape.utime - before.utime) / (double) (after.utime - before.utime));
      }
    }

    private boolean isKnown(shape_t shape) {
      return shape.mesh_hash == shapeMesh.hash && shape.xyz_count == shapeMesh.rest.length;
    }

    /** Relative to the truth interpolated at this fraction between the last two. */
    private void score(shape_t shape, double part) {
      double sum = 0;
      double squares = 0;
      double most = 0;
      double[] a = new double[3];
      double[] b = new double[3];
      for (int p = 0; p < points.count(); ++p) {
        points.at(before.xyz, p, a);
        points.at(after.xyz, p, b);
        double square = 0;
        for (int axis = 0; axis < 3; ++axis) {
          double truth = (1 - part) * a[axis] + part * b[axis];
          double off = shape.xyz[3 * p + axis] - truth;
          square += off * off;
        }
        sum += Math.sqrt(square);
        squares += square;
        most = Math.max(most, Math.sqrt(square));
      }
      if (first == 0) first = shape.utime;
      double n = points.count();
      latest = new double[] {(shape.utime - first) * 1e-6, 1e3 * sum / n,
          1e3 * Math.sqrt(squares / n), 1e3 * most};
      scored.add(latest);
    }

    @Override
    public void redraw() {
      List<double[]> fresh;
      String line;
      synchronized (this) {
        fresh = new ArrayList<>(scored);
        scored.clear();
        line = words();
      }
      for (double[] one : fresh) {
        mean.addPoint(one[0], one[1]);
        rms.addPoint(one[0], one[2]);
        maximum.addPoint(one[0], one[3]);
      }
      words.setText(line);
    }

    @Override
    public synchronized boolean isReady() {
      return latest != null;
    }

    @Override
    public synchronized String words() {
      if (latest != null) {
        return String.format(
            "mean %.2f mm, RMS %.2f mm, largest %.2f mm, at %d nodes; %.1f s%s", latest[1],
            latest[2], latest[3], points == null ? 0 : points.count(), latest[0],
            byArrival ? "; the clocks differ: as they arrive" : "");
      }
      if (!state.isEmpty()) return state;
      List<String> lacking = new ArrayList<>();
      if (shapeMesh == null) lacking.add("SHAPE_MESH" + suffix);
      if (truthMesh == null) lacking.add("TRUTH_MESH" + suffix);
      if (waiting.isEmpty()) lacking.add("SHAPE" + suffix);
      if (after == null) lacking.add("TRUTH_SHAPE" + suffix + " (from a simulator)");
      return lacking.isEmpty() ? "waits for a shape and a truth of one time"
          : "waits for " + String.join(", ", lacking);
    }
  }
}
