#include "tests/bench/core/elasticity/round_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "core/mesh/surface.hpp"

namespace palpate::bench {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using mesh::ElementOrder;

constexpr double kPi = 3.14159265358979323846;
constexpr elasticity::Material kMaterial{1e5, 0.35, 300};
constexpr double kLength = 0.20, kRadius = 0.025;  // m, of the cylinder
const Vector3d kHalfAxes(0.05, 0.03, 0.03);        // m, of the ellipsoid

/// Projects a rest point near the surface onto it.
using Projection = std::function<Vector3d(const Vector3d&)>;
/// Whether a point on the surface (a corner, or the centroid of a triangle) belongs to a region.
using Region = std::function<bool(const Vector3d&)>;

void curve(mesh::ElementMesh& mesh, const Region& is_round, const Projection& project) {
  const mesh::Surface surface = mesh::extract_surface(mesh);
  const std::set<int> outside(surface.nodes.begin(), surface.nodes.end());
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int m = 0; m < 6; ++m) {
      const auto [i, j] = mesh::kTetrahedronEdges[m];
      const int node = mesh.elements(4 + m, e);
      if (outside.count(node) == 0 || !is_round(mesh.nodes.col(mesh.elements(i, e))) ||
          !is_round(mesh.nodes.col(mesh.elements(j, e)))) {
        continue;
      }
      mesh.nodes.col(node) = project(mesh.nodes.col(node));
    }
  }
}

double volume_of(const mesh::TetrahedralMesh& mesh) {
  double sum = 0;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) sum += mesh::volume(mesh, t);
  return sum;
}

/// Integrals of the shape functions over the triangles of a region, by node, that sum to 1; faces
/// may be curved. Midside nodes of a triangle are in the order of edges 01, 12, 20.
Eigen::VectorXd shares(const mesh::ElementMesh& mesh, const Region& region) {
  const mesh::Surface surface = mesh::extract_surface(mesh);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh.node_count());
  const double root = std::sqrt(15.0);
  for (const std::vector<int>& nodes : surface.triangle_nodes) {
    const Matrix3Xd at = mesh.nodes(Eigen::all, nodes);
    if (!region(at.leftCols<3>().rowwise().mean())) continue;
    const auto add = [&](const Vector3d& b, double weight) {  // barycentric place, share of area
      const auto n = static_cast<int>(nodes.size());
      Eigen::VectorXd shape(n);
      Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(3, n);  // by b
      for (int i = 0; i < 3; ++i) {
        shape(i) = n == 3 ? b(i) : b(i) * (2 * b(i) - 1);
        slope(i, i) = n == 3 ? 1 : 4 * b(i) - 1;
        if (n == 3) continue;
        const int j = (i + 1) % 3;
        shape(3 + i) = 4 * b(i) * b(j);
        slope(i, 3 + i) = 4 * b(j);
        slope(j, 3 + i) = 4 * b(i);
      }
      const Vector3d u = at * (slope.row(1) - slope.row(0)).transpose();
      const Vector3d v = at * (slope.row(2) - slope.row(0)).transpose();
      const double area = 0.5 * weight * u.cross(v).norm();
      for (int a = 0; a < n; ++a) sum(nodes[a]) += area * shape(a);
    };
    // Seven points, exact for degree 5 (Radon 1948).
    add(Vector3d::Constant(1.0 / 3), 9.0 / 40);
    for (const double sign : {-1.0, 1.0}) {
      const double far = (6 + sign * root) / 21;
      for (int i = 0; i < 3; ++i) {
        Vector3d place = Vector3d::Constant(far);
        place(i) = 1 - 2 * far;
        add(place, (155 + sign * root) / 1200);
      }
    }
  }
  return sum / sum.sum();
}

RoundBody finish(mesh::ElementMesh mesh, const Region& clamp, const Region& loaded,
                 const Vector3d& force) {
  RoundBody round;
  const mesh::Surface surface = mesh::extract_surface(mesh);
  std::set<int> fixed;
  for (const std::vector<int>& nodes : surface.triangle_nodes) {
    const Vector3d centroid =
        (mesh.nodes.col(nodes[0]) + mesh.nodes.col(nodes[1]) + mesh.nodes.col(nodes[2])) / 3;
    if (clamp(centroid)) fixed.insert(nodes.begin(), nodes.end());
  }
  round.loads = force * shares(mesh, loaded).transpose();
  round.body.mesh = std::move(mesh);
  round.body.material = kMaterial;
  round.body.fixed_nodes.assign(fixed.begin(), fixed.end());
  return round;
}

/// A disc of radius 1 (y, z) and its triangles; ring k has 6 k nodes.
struct Disc {
  std::vector<Eigen::Vector2d> nodes;
  std::vector<std::array<int, 3>> triangles;
};

Disc make_disc(int rings) {
  Disc disc;
  const auto node = [](int ring, int i) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + i % (6 * ring);
  };
  disc.nodes.emplace_back(0, 0);
  for (int k = 1; k <= rings; ++k) {
    for (int i = 0; i < 6 * k; ++i) {
      const double angle = 2 * kPi * i / (6 * k), radius = static_cast<double>(k) / rings;
      disc.nodes.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    for (int sextant = 0; sextant < 6; ++sextant) {
      const int in = sextant * (k - 1), out = sextant * k;
      for (int i = 0; i < k; ++i) {
        disc.triangles.push_back({node(k - 1, in + i), node(k, out + i), node(k, out + i + 1)});
        if (i == k - 1) continue;
        disc.triangles.push_back(
            {node(k - 1, in + i), node(k, out + i + 1), node(k - 1, in + i + 1)});
      }
    }
  }
  return disc;
}

/// Vertices of a regular icosahedron with two on the x axis, on the unit sphere: the first is +x,
/// the last -x.
std::vector<Vector3d> icosahedron() {
  std::vector<Vector3d> all{Vector3d::UnitX()};
  for (const double side : {1.0, -1.0}) {
    for (int k = 0; k < 5; ++k) {
      const double angle = 2 * kPi * (k + (side < 0 ? 0.5 : 0)) / 5, r = 2 / std::sqrt(5.0);
      all.emplace_back(side / std::sqrt(5.0), r * std::cos(angle), r * std::sin(angle));
    }
  }
  all.emplace_back(-Vector3d::UnitX());
  return all;
}

/// Its faces, in rising order of vertices; the first five have the vertex +x, the last five -x.
std::vector<std::array<int, 3>> icosahedron_faces() {
  std::vector<std::array<int, 3>> first, middle, last;
  for (int k = 0; k < 5; ++k) {
    const int next = (k + 1) % 5;
    first.push_back({0, 1 + k, 1 + next});
    middle.push_back({1 + k, 1 + next, 6 + k});
    middle.push_back({1 + next, 6 + k, 6 + next});
    last.push_back({6 + k, 6 + next, 11});
  }
  first.insert(first.end(), middle.begin(), middle.end());
  first.insert(first.end(), last.begin(), last.end());
  for (auto& face : first) std::sort(face.begin(), face.end());
  return first;
}

/// Which face of the icosahedron a point of the unit sphere lies on.
int face_of(const Vector3d& direction) {
  static const auto kFaces = icosahedron_faces();
  static const auto kVertices = icosahedron();
  int best = 0;
  double nearest = -1;
  for (int f = 0; f < static_cast<int>(kFaces.size()); ++f) {
    const auto& [i, j, k] = kFaces[f];
    const double dot = direction.dot((kVertices[i] + kVertices[j] + kVertices[k]).normalized());
    if (dot > nearest) {
      nearest = dot;
      best = f;
    }
  }
  return best;
}

}  // namespace

RoundBody make_cylinder(int rings, int layers, ElementOrder order, Sides sides) {
  const Disc disc = make_disc(rings);
  const auto in_layer = static_cast<int>(disc.nodes.size());
  mesh::TetrahedralMesh mesh;
  mesh.nodes.resize(3, in_layer * (layers + 1));
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Eigen::Vector2d place = kRadius * disc.nodes[n % in_layer];
    mesh.nodes.col(n) = Vector3d(kLength * (n / in_layer) / layers, place.x(), place.y());
  }
  mesh.tetrahedra.resize(4, 3 * layers * static_cast<int>(disc.triangles.size()));
  int t = 0;
  for (int layer = 0; layer < layers; ++layer) {
    for (std::array<int, 3> prism : disc.triangles) {
      // Diagonals lead up from lower numbers, so that faces match.
      std::sort(prism.begin(), prism.end());
      const int below = layer * in_layer, above = below + in_layer;
      const auto [a, b, c] = prism;
      mesh.tetrahedra.col(t++) << below + a, below + b, below + c, above + c;
      mesh.tetrahedra.col(t++) << below + a, below + b, above + b, above + c;
      mesh.tetrahedra.col(t++) << below + a, above + a, above + b, above + c;
    }
  }
  mesh::orient(mesh);
  if (sides == Sides::kInflated) {
    const double grown = std::sqrt(kPi * kRadius * kRadius * kLength / volume_of(mesh));
    mesh.nodes.bottomRows<2>() *= grown;
  }
  mesh::ElementMesh elements = mesh::make_element_mesh(mesh, order);
  if (sides == Sides::kCurved) {
    curve(
        elements, [](const Vector3d& p) { return p.tail<2>().norm() > 0.9999 * kRadius; },
        [](const Vector3d& p) {
          Vector3d on = p;
          on.tail<2>() *= kRadius / p.tail<2>().norm();
          return on;
        });
  }
  constexpr double kTiny = 1e-9;
  RoundBody round = finish(
      std::move(elements), [](const Vector3d& p) { return p.x() < kTiny; },
      [](const Vector3d& p) { return p.x() > kLength - kTiny; }, {0, 0, -0.5});
  for (int k = 1; k <= 4; ++k) {
    for (const auto& [y, z] : {std::pair{0, 0}, {1, 0}, {-1, 0}}) {
      round.probes.emplace_back(kLength * k / 4, kRadius * y, kRadius * z);
    }
  }
  return round;
}

RoundBody make_ellipsoid(int m, ElementOrder order, Sides sides) {
  const std::vector<Vector3d> vertices = icosahedron();
  mesh::TetrahedralMesh mesh;
  std::map<std::array<long, 3>, int> known;  // by place in the icosahedron
  std::vector<Vector3d> nodes;
  const auto node = [&](const Vector3d& p, double shell) {
    std::array<long, 3> key{};
    for (int i = 0; i < 3; ++i) key[i] = std::lround(1e7 * p(i));
    const auto [found, is_new] = known.try_emplace(key, static_cast<int>(nodes.size()));
    if (is_new) nodes.push_back(shell > 0 ? Vector3d(shell * p.normalized()) : p);
    return found->second;
  };
  // A simplex 1 >= x >= y >= z of a cube divided into m^3 cells is a union of those of the cells:
  // Kuhn.
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<Eigen::Vector4i> tetrahedra;
  for (const auto& [i, j, k] : icosahedron_faces()) {
    for (int cell = 0; cell < m * m * m; ++cell) {
      for (const auto& axes : kOrders) {
        Eigen::Vector3i at(cell % m, cell / m % m, cell / m / m);
        Eigen::Vector4i corners;
        bool inside = true;
        for (int c = 0; c < 4; ++c) {
          inside = inside && at(0) >= at(1) && at(1) >= at(2);
          if (!inside) break;
          const Eigen::Vector3d s = at.cast<double>() / m;
          const Vector3d p = s(0) * vertices[i] + s(1) * (vertices[j] - vertices[i]) +
                             s(2) * (vertices[k] - vertices[j]);
          corners(c) = node(p, s(0));
          if (c < 3) ++at(axes[c]);
        }
        if (inside) tetrahedra.push_back(corners);
      }
    }
  }
  mesh.nodes.resize(3, static_cast<int>(nodes.size()));
  for (int n = 0; n < mesh.node_count(); ++n) mesh.nodes.col(n) = kHalfAxes.cwiseProduct(nodes[n]);
  mesh.tetrahedra.resize(4, static_cast<int>(tetrahedra.size()));
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) mesh.tetrahedra.col(t) = tetrahedra[t];
  mesh::orient(mesh);
  if (sides == Sides::kInflated) {
    mesh.nodes *= std::cbrt(4 * kPi / 3 * kHalfAxes.prod() / volume_of(mesh));
  }
  mesh::ElementMesh elements = mesh::make_element_mesh(mesh, order);
  const auto direction = [](const Vector3d& p) { return p.cwiseQuotient(kHalfAxes); };
  if (sides == Sides::kCurved) {
    curve(
        elements, [&](const Vector3d& p) { return direction(p).norm() > 0.9999; },
        [&](const Vector3d& p) {
          return Vector3d(kHalfAxes.cwiseProduct(direction(p).normalized()));
        });
  }
  RoundBody round = finish(
      std::move(elements), [&](const Vector3d& p) { return face_of(direction(p)) >= 15; },
      [&](const Vector3d& p) { return face_of(direction(p)) < 5; }, {-3, 0, 2});
  round.probes.emplace_back(Vector3d::Zero());
  for (int v = 0; v < 6; ++v) round.probes.emplace_back(kHalfAxes.cwiseProduct(vertices[v]));
  return round;
}

}  // namespace palpate::bench
