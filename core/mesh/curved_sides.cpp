#include "core/mesh/curved_sides.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "core/mesh/connectivity.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

// Relative to an edge's length: rounding errors of a file, and more than any sensible mesh has (a
// square for a circle: 0.2).
constexpr double kFlatBulge = 1e-7, kMostBulge = 0.25;

/// Boundary sides: corners (outward by the right-hand rule), then the midpoints of the edges 01,
/// 12, 20.
using Side = Eigen::Matrix<double, 3, 6>;

Vector3d middle(const TetrahedralMesh& mesh, const EdgeMiddles& middles, int a, int b) {
  const auto found = middles.find(std::minmax(a, b));
  if (found != middles.end()) return found->second;
  return 0.5 * (mesh.nodes.col(a) + mesh.nodes.col(b));
}

Side side_of(const TetrahedralMesh& mesh, const EdgeMiddles& middles, const Eigen::Vector3i& t) {
  Side side;
  for (int i = 0; i < 3; ++i) {
    side.col(i) = mesh.nodes.col(t[i]);
    side.col(3 + i) = middle(mesh, middles, t[i], t[(i + 1) % 3]);
  }
  return side;
}

/// 1/3 of the integral of x . n over a quadratic triangle, exact: the six-point rule of Strang and
/// Fix integrates polynomials of degree four.
double volume_below(const Side& side) {
  constexpr double kA[] = {0.445948490915965, 0.091576213509771};
  constexpr double kWeight[] = {0.223381589678011 / 2, 0.109951743655322 / 2};
  double sum = 0;
  for (int orbit = 0; orbit < 2; ++orbit) {
    for (int k = 0; k < 3; ++k) {
      Vector3d b = Vector3d::Constant(kA[orbit]);
      b[k] = 1 - 2 * kA[orbit];
      Eigen::Matrix<double, 6, 1> shape, by_u, by_v;  // u = b1, v = b2
      shape << b[0] * (2 * b[0] - 1), b[1] * (2 * b[1] - 1), b[2] * (2 * b[2] - 1), 4 * b[0] * b[1],
          4 * b[1] * b[2], 4 * b[2] * b[0];
      by_u << 1 - 4 * b[0], 4 * b[1] - 1, 0, 4 * (b[0] - b[1]), 4 * b[2], -4 * b[2];
      by_v << 1 - 4 * b[0], 0, 4 * b[2] - 1, -4 * b[1], 4 * b[1], 4 * (b[0] - b[2]);
      const Vector3d along_u = side * by_u, along_v = side * by_v;
      sum += kWeight[orbit] * (side * shape).dot(along_u.cross(along_v));
    }
  }
  return sum / 3;
}

}  // namespace

double curved_volume(const TetrahedralMesh& mesh, const EdgeMiddles& middles) {
  const Surface surface = extract_surface(mesh);
  double sum = 0;
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    sum += volume_below(side_of(mesh, middles, surface.triangles.col(t)));
  }
  return sum;
}

double keep_curved_volume(TetrahedralMesh& mesh, const EdgeMiddles& middles) {
  const Surface surface = extract_surface(mesh);
  // each corner moves along the mean normal of its curved sides, by their mean deviation
  Eigen::Matrix3Xd outward = Eigen::Matrix3Xd::Zero(3, mesh.node_count());
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(mesh.node_count());
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const Side side = side_of(mesh, middles, corners);
    const Vector3d normal = (side.col(1) - side.col(0)).cross(side.col(2) - side.col(0));
    double bulge = 0, longest = 0;
    for (int i = 0; i < 3; ++i) {
      const Vector3d edge = side.col((i + 1) % 3) - side.col(i);
      const Vector3d bent = side.col(3 + i) - (side.col(i) + 0.5 * edge);
      bulge += bent.dot(normal.normalized()) / 3;
      longest = std::max(longest, edge.norm());
    }
    if (std::abs(bulge) < kFlatBulge * longest) continue;
    if (!(std::abs(bulge) < kMostBulge * longest)) {
      throw std::invalid_argument("a side of the boundary bulges by " + std::to_string(bulge) +
                                  " m, too much for edges of " + std::to_string(longest) +
                                  " m: use smaller elements");
    }
    for (int corner : corners) {
      outward.col(corner) += bulge * normal;
      weight[corner] += normal.norm();
    }
  }
  if (weight.isZero(0)) return 0;
  for (int i = 0; i < mesh.node_count(); ++i) {
    if (weight[i] > 0) outward.col(i) /= weight[i];
  }

  const double wanted = curved_volume(mesh, middles);
  const TetrahedralMesh inscribed = mesh;
  const auto volume_at = [&](double share) {
    mesh.nodes = inscribed.nodes + share * outward;
    return curved_volume(mesh, {});
  };
  // the volume is a cubic function of the share, nearly linear
  double before = 0, share = 1, volume_before = volume_at(0);
  for (int i = 0; i < 20; ++i) {
    const double volume_now = volume_at(share);
    if (std::abs(volume_now - wanted) < 1e-12 * wanted || volume_now == volume_before) break;
    const double next =
        share + (wanted - volume_now) * (share - before) / (volume_now - volume_before);
    before = share;
    volume_before = volume_now;
    share = next;
  }
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    if (volume(mesh, t) > 0) continue;
    mesh = inscribed;
    throw std::invalid_argument("sides are too curved: tetrahedron " + std::to_string(t) +
                                " would be inside out");
  }
  return (mesh.nodes - inscribed.nodes).colwise().norm().maxCoeff();
}

}  // namespace palpate::mesh
