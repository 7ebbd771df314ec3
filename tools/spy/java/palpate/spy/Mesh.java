package palpate.spy;

import java.util.TreeMap;
import palpate.shape_mesh_t;

/** A mesh assembled from the chunks of SHAPE_MESH or TRUTH_MESH. */
final class Mesh {
  long hash;
  int elementKind;
  int elementSize;
  float[] rest = new float[0]; // x y z of every node, m, in O
  int[] elements = new int[0];
  int[] triangles = new int[0];
  int[] constrained = new int[0];

  int nodeCount() {
    return rest.length / 3;
  }

  /** Collects chunks until a mesh is complete. */
  static final class Builder {
    private final TreeMap<Integer, shape_mesh_t> chunks = new TreeMap<>();
    private long hash;
    private Mesh whole;

    /** The new mesh if this chunk completed it; otherwise null. */
    Mesh add(shape_mesh_t chunk) {
      if (whole != null && chunk.mesh_hash == whole.hash) return null;
      if (chunk.mesh_hash != hash) chunks.clear();
      hash = chunk.mesh_hash;
      if (chunk.chunk < 0 || chunk.chunk >= chunk.chunks) return null;
      chunks.put((int) chunk.chunk, chunk);
      if (chunks.size() < chunk.chunks) return null;
      Mesh made = join();
      chunks.clear();
      if (made != null) whole = made;
      return made;
    }

    /** Null if the chunks are contradictory. */
    private Mesh join() {
      shape_mesh_t first = chunks.firstEntry().getValue();
      int largest = 1 << 20;
      if (first.corner_count < 1 || first.corner_count > largest) return null;
      Mesh mesh = new Mesh();
      mesh.hash = first.mesh_hash;
      mesh.elementKind = first.element_kind;
      mesh.elementSize = first.element_size;
      mesh.rest = new float[3 * first.corner_count];
      for (shape_mesh_t chunk : chunks.values()) {
        int at = 3 * chunk.first_node;
        if (at < 0 || at + chunk.rest_xyz_count > mesh.rest.length) return null;
        System.arraycopy(chunk.rest_xyz, 0, mesh.rest, at, chunk.rest_xyz_count);
        mesh.elements = joined(mesh.elements, chunk.elements);
        mesh.triangles = joined(mesh.triangles, chunk.triangles);
        mesh.constrained = joined(mesh.constrained, chunk.constrained);
      }
      return mesh.isSound() ? mesh : null;
    }

    private static int[] joined(int[] a, int[] b) {
      int[] both = java.util.Arrays.copyOf(a, a.length + b.length);
      System.arraycopy(b, 0, both, a.length, b.length);
      return both;
    }
  }

  private boolean isSound() {
    boolean sized = elementSize > 0 && elements.length % elementSize == 0;
    return sized && triangles.length % 3 == 0 && names(elements) && names(triangles)
        && names(constrained);
  }

  /** Whether every index refers to a node. */
  private boolean names(int[] indices) {
    for (int index : indices) {
      if (index < 0 || index >= nodeCount()) return false;
    }
    return true;
  }
}
