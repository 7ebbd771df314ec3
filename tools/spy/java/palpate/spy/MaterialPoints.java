package palpate.spy;

import palpate.shape_mesh_t;

/**
 * Points of the rest shape as weighted sums of another mesh's nodes, with which they move. Elements
 * are linear tetrahedra, or 27-node hexahedra whose rest shape is a box; the order of the nodes in
 * a hexahedron is arbitrary. A point outside uses the nearest element.
 */
final class MaterialPoints {
  private final int perPoint;
  private final int[] nodes;
  private final double[] weights;

  /** Throws IllegalArgumentException for other elements. `points`: x y z of each, m, at rest. */
  MaterialPoints(Mesh mesh, float[] points) {
    boolean boxes =
        mesh.elementKind == shape_mesh_t.QUADRATIC_HEXAHEDRA && mesh.elementSize == 27;
    if (!boxes && mesh.elementSize != 4) {
      throw new IllegalArgumentException(
          "the mesh is neither one of 27-node hexahedra nor of tetrahedra");
    }
    perPoint = mesh.elementSize;
    nodes = new int[perPoint * (points.length / 3)];
    weights = new double[nodes.length];
    for (int p = 0; p < points.length / 3; ++p) {
      double[] point = {points[3 * p], points[3 * p + 1], points[3 * p + 2]};
      if (boxes) {
        placeInBoxes(mesh, p, point);
      } else {
        placeInTetrahedra(mesh, p, point);
      }
    }
  }

  int count() {
    return nodes.length / perPoint;
  }

  /** Position of point `p` for the mesh's nodes at `xyz`. */
  void at(float[] xyz, int p, double[] into) {
    into[0] = into[1] = into[2] = 0;
    for (int i = p * perPoint; i < (p + 1) * perPoint; ++i) {
      for (int axis = 0; axis < 3; ++axis) into[axis] += weights[i] * xyz[3 * nodes[i] + axis];
    }
  }

  private void placeInBoxes(Mesh mesh, int p, double[] point) {
    int best = -1;
    double least = Double.MAX_VALUE;
    double[][] chosen = null;
    for (int e = 0; e < mesh.elements.length; e += perPoint) {
      double[][] box = boxOf(mesh, e);
      double distance = 0;
      for (int axis = 0; axis < 3; ++axis) {
        double beyond =
            Math.max(0, Math.max(box[0][axis] - point[axis], point[axis] - box[1][axis]));
        distance += beyond * beyond;
      }
      if (distance >= least) continue;
      least = distance;
      best = e;
      chosen = box;
    }
    for (int i = 0; i < perPoint; ++i) {
      int node = mesh.elements[best + i];
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) {
        double size = chosen[1][axis] - chosen[0][axis];
        double at = (mesh.rest[3 * node + axis] - chosen[0][axis]) / size;
        weight *= lagrange(at, (point[axis] - chosen[0][axis]) / size);
      }
      nodes[p * perPoint + i] = node;
      weights[p * perPoint + i] = weight;
    }
  }

  private double[][] boxOf(Mesh mesh, int element) {
    double[][] box = new double[2][3];
    for (int axis = 0; axis < 3; ++axis) {
      box[0][axis] = Double.MAX_VALUE;
      box[1][axis] = -Double.MAX_VALUE;
      for (int i = 0; i < perPoint; ++i) {
        double x = mesh.rest[3 * mesh.elements[element + i] + axis];
        box[0][axis] = Math.min(box[0][axis], x);
        box[1][axis] = Math.max(box[1][axis], x);
      }
    }
    return box;
  }

  /** At s, of the quadratic polynomial on 0, 1/2 and 1 that is 1 at `node`. */
  private static double lagrange(double node, double s) {
    if (node < 0.25) return 2 * (s - 0.5) * (s - 1);
    if (node > 0.75) return 2 * s * (s - 0.5);
    return 4 * s * (1 - s);
  }

  private void placeInTetrahedra(Mesh mesh, int p, double[] point) {
    double most = -Double.MAX_VALUE;
    for (int e = 0; e < mesh.elements.length; e += 4) {
      double[] w = barycentric(mesh, e, point);
      double least = Math.min(Math.min(w[0], w[1]), Math.min(w[2], w[3]));
      if (!(least > most)) continue;
      most = least;
      for (int i = 0; i < 4; ++i) {
        nodes[4 * p + i] = mesh.elements[e + i];
        weights[4 * p + i] = w[i];
      }
    }
  }

  private static double[] barycentric(Mesh mesh, int element, double[] point) {
    double[][] x = new double[4][3];
    for (int i = 0; i < 4; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        x[i][axis] = mesh.rest[3 * mesh.elements[element + i] + axis];
      }
    }
    double whole = volume(x[0], x[1], x[2], x[3]);
    return new double[] {volume(point, x[1], x[2], x[3]) / whole,
        volume(x[0], point, x[2], x[3]) / whole, volume(x[0], x[1], point, x[3]) / whole,
        volume(x[0], x[1], x[2], point) / whole};
  }

  /** Six times the volume, with sign. */
  private static double volume(double[] a, double[] b, double[] c, double[] d) {
    double[] u = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double[] v = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double[] w = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
        + u[2] * (v[0] * w[1] - v[1] * w[0]);
  }
}
