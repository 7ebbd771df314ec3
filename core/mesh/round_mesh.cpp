#include "core/mesh/round_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>

#include "core/mesh/connectivity.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kOnSurface = 1e-9;  // relative to the body's size

/// Rings of a disc of radius 1.
struct Disc {
  std::vector<Vector2d> nodes;
  std::vector<std::array<int, 3>> triangles;
};

Disc make_disc(int rings) {
  // ring k begins at node 1 + 3 k (k - 1); its nodes are at equal angles
  const auto node = [](int ring, int i) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + i % (6 * ring);
  };
  Disc disc;
  disc.nodes.emplace_back(0, 0);
  for (int ring = 1; ring <= rings; ++ring) {
    for (int i = 0; i < 6 * ring; ++i) {
      const double angle = 2 * EIGEN_PI * i / (6 * ring);
      disc.nodes.push_back(ring * Vector2d(std::cos(angle), std::sin(angle)) / rings);
    }
    for (int sector = 0; sector < 6; ++sector) {
      const int inner = sector * (ring - 1), outer = sector * ring;
      for (int i = 0; i < ring; ++i) {
        disc.triangles.push_back(
            {node(ring - 1, inner + i), node(ring, outer + i), node(ring, outer + i + 1)});
        if (i + 1 < ring) {
          disc.triangles.push_back({node(ring - 1, inner + i), node(ring, outer + i + 1),
                                    node(ring - 1, inner + i + 1)});
        }
      }
    }
  }
  return disc;
}

double total_volume(const TetrahedralMesh& mesh) {
  double sum = 0;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) sum += volume(mesh, t);
  return sum;
}

using Place = std::function<Vector3d(const Vector3d&)>;
// Whether a corner lies on the curved surface.
using IsRound = std::function<bool(const Vector3d&)>;

/// Midpoints of boundary edges between corners on the curved surface, projected onto it.
void curve(MeshWithGroups& result, const IsRound& is_round, const Place& onto_surface) {
  for (const auto& [edge, triangles] : triangles_by_edge(extract_surface(result.mesh).triangles)) {
    const Vector3d from = result.mesh.nodes.col(edge.first),
                   to = result.mesh.nodes.col(edge.second);
    if (is_round(from) && is_round(to)) result.middles[edge] = onto_surface(0.5 * (from + to));
  }
}

/// Corners of an icosahedron on the unit sphere, two of them on the x axis, and its faces.
struct Icosahedron {
  std::vector<Vector3d> corners;
  std::vector<std::array<int, 3>> faces;
};

Icosahedron make_icosahedron() {
  Icosahedron solid;
  const double x = std::sqrt(0.2), r = 2 * x;
  solid.corners.emplace_back(1, 0, 0);
  for (int i = 0; i < 10; ++i) {
    const double angle = EIGEN_PI * i / 5;
    solid.corners.emplace_back(i % 2 == 0 ? x : -x, r * std::cos(angle), r * std::sin(angle));
  }
  solid.corners.emplace_back(-1, 0, 0);
  // faces are triples of neighbours; other corners are at least 1.7 apart
  const double edge = (solid.corners[0] - solid.corners[1]).norm();
  const auto are_near = [&](int i, int j) {
    return (solid.corners[i] - solid.corners[j]).norm() < 1.1 * edge;
  };
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        if (are_near(i, j) && are_near(j, k) && are_near(i, k)) solid.faces.push_back({i, j, k});
      }
    }
  }
  return solid;
}

/// The tetrahedron 1 >= x >= y >= z >= 0 divided into cells^3 parts, in integer coordinates from 0
/// to `cells`: Kuhn's decomposition of the cube's cells, of which it is a union.
std::vector<std::array<Eigen::Vector3i, 4>> cut_simplex(int cells) {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<std::array<Eigen::Vector3i, 4>> all;
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j <= i; ++j) {
      for (int k = 0; k <= j; ++k) {
        for (const auto& order : kOrders) {
          std::array<Eigen::Vector3i, 4> corners;
          corners[0] = Eigen::Vector3i(i, j, k);
          for (int c = 0; c < 3; ++c) {
            corners[c + 1] = corners[c];
            ++corners[c + 1][order[c]];
          }
          if (std::all_of(corners.begin(), corners.end(),
                          [](const Eigen::Vector3i& p) { return p[0] >= p[1] && p[1] >= p[2]; }))
            all.push_back(corners);
        }
      }
    }
  }
  return all;
}

}  // namespace

MeshWithGroups make_cylinder(double radius, double length, int rings, int layers,
                             RoundSides sides) {
  if (!(radius > 0) || !(length > 0) || rings < 1 || layers < 1) {
    throw std::invalid_argument("a cylinder needs positive radius, length, rings and layers");
  }
  const Disc disc = make_disc(rings);
  const auto in_layer = static_cast<int>(disc.nodes.size());
  MeshWithGroups result;
  TetrahedralMesh& mesh = result.mesh;
  mesh.nodes.resize(3, in_layer * (layers + 1));
  for (int layer = 0; layer <= layers; ++layer) {
    for (int i = 0; i < in_layer; ++i) {
      mesh.nodes.col(layer * in_layer + i) << length * layer / layers, radius * disc.nodes[i];
    }
  }
  mesh.tetrahedra.resize(4, 3 * layers * static_cast<int>(disc.triangles.size()));
  int t = 0;
  for (int layer = 0; layer < layers; ++layer) {
    const int below = layer * in_layer, above = below + in_layer;
    for (std::array<int, 3> c : disc.triangles) {
      // the path from (lowest, below) to (highest, above) rises at each corner in turn, so that
      // rectangles are divided alike from both sides
      std::sort(c.begin(), c.end());
      mesh.tetrahedra.col(t++) << below + c[0], below + c[1], below + c[2], above + c[2];
      mesh.tetrahedra.col(t++) << below + c[0], below + c[1], above + c[1], above + c[2];
      mesh.tetrahedra.col(t++) << below + c[0], above + c[0], above + c[1], above + c[2];
    }
  }
  orient(mesh);
  if (sides == RoundSides::kFull) {
    const double grown = std::sqrt(EIGEN_PI * radius * radius * length / total_volume(mesh));
    mesh.nodes.bottomRows<2>() *= grown;
  } else {
    curve(
        result, [&](const Vector3d& p) { return p.tail<2>().norm() > (1 - kOnSurface) * radius; },
        [&](const Vector3d& p) {
          const Vector2d out = radius * p.tail<2>().normalized();
          return Vector3d(p.x(), out.x(), out.y());
        });
  }
  group_sides(result, [&](const Eigen::Matrix3d& corners) -> std::string {
    if (corners.row(0).maxCoeff() < kOnSurface * length) return "x_min";
    if (corners.row(0).minCoeff() > (1 - kOnSurface) * length) return "x_max";
    return "side";
  });
  return result;
}

MeshWithGroups make_ellipsoid(const Vector3d& half_axes, int cells, RoundSides sides) {
  if (!(half_axes.array() > 0).all() || cells < 1) {
    throw std::invalid_argument("an ellipsoid needs positive half axes and cells");
  }
  const Icosahedron solid = make_icosahedron();
  const auto simplex = cut_simplex(cells);
  std::map<std::array<long, 3>, int> known;  // by position in the icosahedron
  std::vector<Vector3d> nodes;               // in the unit ball
  std::vector<Eigen::Vector4i> tetrahedra;
  const auto node = [&](const std::array<int, 3>& face, const Eigen::Vector3i& at) {
    // corners of the tetrahedron in order: the centre, then those of the face
    const Vector3d p = (at[0] - at[1]) * solid.corners[face[0]] +
                       (at[1] - at[2]) * solid.corners[face[1]] + at[2] * solid.corners[face[2]];
    const auto rounded = [](double v) { return std::lround(1e6 * v); };
    const auto [found, is_new] = known.try_emplace({rounded(p.x()), rounded(p.y()), rounded(p.z())},
                                                   static_cast<int>(nodes.size()));
    if (is_new) {
      nodes.push_back(at[0] == 0 ? Vector3d::Zero().eval()
                                 : Vector3d(p.normalized() * at[0] / cells));
    }
    return found->second;
  };
  for (const auto& face : solid.faces) {
    for (const auto& corners : simplex) {
      Eigen::Vector4i& t = tetrahedra.emplace_back();
      for (int c = 0; c < 4; ++c) t[c] = node(face, corners[c]);
    }
  }
  MeshWithGroups result;
  TetrahedralMesh& mesh = result.mesh;
  mesh.nodes.resize(3, static_cast<int>(nodes.size()));
  for (int n = 0; n < mesh.node_count(); ++n) mesh.nodes.col(n) = half_axes.cwiseProduct(nodes[n]);
  mesh.tetrahedra.resize(4, static_cast<int>(tetrahedra.size()));
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) mesh.tetrahedra.col(t) = tetrahedra[t];
  orient(mesh);
  if (sides == RoundSides::kFull) {
    mesh.nodes *= std::cbrt(4 * EIGEN_PI / 3 * half_axes.prod() / total_volume(mesh));
  } else {
    curve(
        result,
        [&](const Vector3d& p) { return p.cwiseQuotient(half_axes).norm() > 1 - kOnSurface; },
        [&](const Vector3d& p) {
          return Vector3d(half_axes.cwiseProduct(p.cwiseQuotient(half_axes).normalized()));
        });
  }
  group_sides(result, [](const Eigen::Matrix3d&) { return "surface"; });
  return result;
}

void group_sides(MeshWithGroups& mesh,
                 const std::function<std::string(const Eigen::Matrix3d&)>& name) {
  const Surface surface = extract_surface(mesh.mesh);
  std::map<std::string, std::vector<int>> members;
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = mesh.mesh.nodes(Eigen::all, surface.triangles.col(t));
    members[name(corners)].push_back(t);
  }
  members.erase("");
  for (const auto& [key, triangles] : members) {
    MeshGroup& group = mesh.groups[key];
    group.triangles = surface.triangles(Eigen::all, triangles);
    const std::set<int> nodes(group.triangles.reshaped().begin(), group.triangles.reshaped().end());
    group.nodes.assign(nodes.begin(), nodes.end());
  }
  MeshGroup& body = mesh.groups["body"];
  body.tetrahedra.resize(mesh.mesh.tetrahedron_count());
  std::iota(body.tetrahedra.begin(), body.tetrahedra.end(), 0);
  body.nodes.resize(mesh.mesh.node_count());
  std::iota(body.nodes.begin(), body.nodes.end(), 0);
}

}  // namespace palpate::mesh
