package palpate.spy;

import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStream;
import java.io.InputStreamReader;
import java.io.UncheckedIOException;
import java.nio.charset.StandardCharsets;
import java.util.ArrayList;
import java.util.List;

/**
 * Positions of the electrodes on the unrolled skin, in mm: u along the finger towards the tip, v
 * around it. The file is generated at build time from the sensor's published geometry.
 */
final class ElectrodeLayout {
  static final int COUNT = 19;
  private static final String FILE = "electrodes.csv";

  final double[] u = new double[COUNT];
  final double[] v = new double[COUNT];

  ElectrodeLayout() {
    List<String> lines = new ArrayList<>();
    try (InputStream stream = ElectrodeLayout.class.getResourceAsStream(FILE)) {
      if (stream == null) throw new IllegalStateException("the jar lacks " + FILE);
      BufferedReader reader =
          new BufferedReader(new InputStreamReader(stream, StandardCharsets.US_ASCII));
      for (String line = reader.readLine(); line != null; line = reader.readLine()) {
        if (!line.startsWith("#")) lines.add(line);
      }
    } catch (IOException error) {
      throw new UncheckedIOException(error);
    }
    if (lines.size() != COUNT) throw new IllegalStateException(FILE + " lacks electrodes");
    for (int i = 0; i < COUNT; ++i) {
      String[] numbers = lines.get(i).split(",");
      u[i] = Double.parseDouble(numbers[0]);
      v[i] = Double.parseDouble(numbers[1]);
    }
  }
}
