#include "tools/export/element_gradients.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include "core/elasticity/element.hpp"
#include "core/math/polar.hpp"

namespace palpate::exporting {
namespace {

struct Lame {
  explicit Lame(const Stiffness& of)
      : mu(of.young_modulus / (2 * (1 + of.poisson_ratio))),
        lambda(of.young_modulus * of.poisson_ratio /
               ((1 + of.poisson_ratio) * (1 - 2 * of.poisson_ratio))) {}
  double mu, lambda;  // Pa
};

constexpr int kTetrahedronNodes = 4, kQuadraticNodes = 10, kHexahedronNodes = 27;

/// Values and slopes on [0, 1] of the quadratic Lagrange polynomials on 0, 1/2, 1.
struct Quadratic {
  explicit Quadratic(double s)
      : value{2 * (s - 0.5) * (s - 1), 4 * s * (1 - s), 2 * s * (s - 0.5)},
        slope{4 * s - 3, 4 - 8 * s, 4 * s - 1} {}
  std::array<double, 3> value, slope;
};

/// Whether each position of the grid of 3 x 3 x 3 nodes is taken exactly once.
bool is_whole(const Eigen::Matrix3Xi& places) {
  std::array<bool, kHexahedronNodes> taken{};
  for (const auto& place : places.colwise()) {
    const int at = place.x() + 3 * place.y() + 9 * place.z();
    taken[static_cast<std::size_t>(at)] = true;
  }
  return std::all_of(taken.begin(), taken.end(), [](bool is_taken) { return is_taken; });
}

Eigen::Matrix3Xd corners_of(const Eigen::Matrix3Xd& nodes, const Eigen::MatrixXi& elements, int e) {
  Eigen::Matrix3Xd corners(3, elements.rows());
  for (int i = 0; i < corners.cols(); ++i) corners.col(i) = nodes.col(elements(i, e));
  return corners;
}

/// First Piola-Kirchhoff stress of the co-rotational law, Pa: R (2 mu E + lambda tr(E) 1).
Eigen::Matrix3d corotational_first_stress(const Eigen::Matrix3d& F, const Stiffness& stiffness) {
  const Lame lame(stiffness);
  const Eigen::Matrix3d R = math::polar_rotation(F);
  const Eigen::Matrix3d strain = R.transpose() * F - Eigen::Matrix3d::Identity();
  return R * (2 * lame.mu * strain + lame.lambda * strain.trace() * Eigen::Matrix3d::Identity());
}

/// Nodes at the centres of hexahedra and of their faces, and of the edges of quadratic tetrahedra.
std::vector<char> middle_nodes(const log::MeshMessage& mesh) {
  std::vector<char> middle(static_cast<std::size_t>(mesh.nodes.cols()), 0);
  const auto set = [&](Eigen::Index e, int i) {
    middle[static_cast<std::size_t>(mesh.elements(i, e))] = 1;
  };
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e) {
    if (mesh.elements.rows() == kQuadraticNodes)
      for (int i = kTetrahedronNodes; i < kQuadraticNodes; ++i) set(e, i);
    if (mesh.elements.rows() != kHexahedronNodes) continue;
    const Eigen::Matrix3Xi places =
        grid_places(corners_of(mesh.nodes, mesh.elements, static_cast<int>(e)));
    for (int i = 0; i < kHexahedronNodes; ++i)
      if ((places.col(i).array() == 1).count() > 1) set(e, i);
  }
  return middle;
}

}  // namespace

Eigen::Matrix3d cauchy_stress(Law law, const Eigen::Matrix3d& F, const Stiffness& stiffness) {
  const double J = std::max(F.determinant(), kSmallestVolumeShare);
  if (law == Law::kCorotational) return corotational_first_stress(F, stiffness) * F.transpose() / J;
  const Lame lame(stiffness);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  return (lame.mu * (F * F.transpose() - one) + lame.lambda * std::log(J) * one) / J;
}

Eigen::Matrix3Xi grid_places(const Eigen::Matrix3Xd& nodes) {
  const Eigen::Array3d lower = nodes.rowwise().minCoeff();
  const Eigen::Array3d size = nodes.rowwise().maxCoeff().array() - lower;
  Eigen::Matrix3Xi places(3, nodes.cols());
  for (int i = 0; i < nodes.cols(); ++i)
    places.col(i) = (2 * (nodes.col(i).array() - lower) / size).round().matrix().cast<int>();
  return places;
}

ElementGradients::ElementGradients(const log::MeshMessage& mesh) : elements_(mesh.elements) {
  if (elements_.rows() == kTetrahedronNodes)
    add_tetrahedra(mesh.nodes);
  else if (elements_.rows() == kQuadraticNodes)
    add_quadratic_tetrahedra(mesh.nodes);
  else if (elements_.rows() == kHexahedronNodes)
    add_hexahedra(mesh.nodes);
  else
    throw std::runtime_error("a mesh whose elements have " + std::to_string(elements_.rows()) +
                             " nodes: neither tetrahedra by corners nor 27-node hexahedra");
}

void ElementGradients::add_tetrahedra(const Eigen::Matrix3Xd& nodes) {
  for (int e = 0; e < elements_.cols(); ++e) {
    const Eigen::Matrix3Xd corners = corners_of(nodes, elements_, e);
    const Eigen::Matrix3d edges = corners.rightCols(3).colwise() - corners.col(0);
    const double volume = edges.determinant() / 6;
    if (!(volume > 0)) throw std::runtime_error("a mesh with a tetrahedron without volume");
    const Eigen::Matrix3d inverse = edges.inverse();
    Eigen::MatrixX3d gradient(kTetrahedronNodes, 3);
    gradient.bottomRows(3) = inverse;
    gradient.row(0) = -inverse.colwise().sum();
    volumes_.push_back(volume);
    gradients_.push_back(gradient);
  }
}

void ElementGradients::add_quadratic_tetrahedra(const Eigen::Matrix3Xd& nodes) {
  using Element = elasticity::Tetrahedron<kQuadraticNodes>;
  points_ = Element::kPoints;
  for (int e = 0; e < elements_.cols(); ++e) {
    const Eigen::Matrix<double, 3, 4> corners = corners_of(nodes, elements_, e).leftCols<4>();
    const double volume = elasticity::tetrahedron_volume(corners);
    if (!(volume > 0)) throw std::runtime_error("a mesh with a tetrahedron without volume");
    for (const auto& gradient : Element::gradients(corners)) {
      volumes_.push_back(volume / points_);
      gradients_.push_back(gradient.transpose());
    }
  }
}

void ElementGradients::add_hexahedra(const Eigen::Matrix3Xd& nodes) {
  points_ = 8;
  const double offset = 0.5 / std::sqrt(3.0);
  for (int e = 0; e < elements_.cols(); ++e) {
    const Eigen::Matrix3Xd corners = corners_of(nodes, elements_, e);
    const Eigen::Matrix3Xi places = grid_places(corners);
    const Eigen::Vector3d size = corners.rowwise().maxCoeff() - corners.rowwise().minCoeff();
    if (!(size.prod() > 0)) throw std::runtime_error("a mesh with a hexahedron without volume");
    if (!is_whole(places))
      throw std::runtime_error("a mesh with a hexahedron that is no box at rest");
    for (int p = 0; p < points_; ++p) {
      const Quadratic x(0.5 + (p & 1 ? offset : -offset)), y(0.5 + (p & 2 ? offset : -offset)),
          z(0.5 + (p & 4 ? offset : -offset));
      Eigen::MatrixX3d gradient(kHexahedronNodes, 3);
      for (int i = 0; i < kHexahedronNodes; ++i) {
        const auto a = static_cast<std::size_t>(places(0, i));
        const auto b = static_cast<std::size_t>(places(1, i));
        const auto c = static_cast<std::size_t>(places(2, i));
        gradient.row(i) << x.slope[a] * y.value[b] * z.value[c] / size.x(),
            x.value[a] * y.slope[b] * z.value[c] / size.y(),
            x.value[a] * y.value[b] * z.slope[c] / size.z();
      }
      volumes_.push_back(size.prod() / points_);
      gradients_.push_back(gradient);
    }
  }
}

Eigen::Matrix3d ElementGradients::at(int element, int point, const Eigen::Matrix3Xd& x) const {
  const Eigen::MatrixX3d& gradient = gradients(element, point);
  Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
  for (int i = 0; i < elements_.rows(); ++i) F += x.col(elements_(i, element)) * gradient.row(i);
  return F;
}

Eigen::Matrix2Xi surface_edges(const log::MeshMessage& mesh, Edges which) {
  const double crease = std::cos(40 * M_PI / 180);
  const std::vector<char> middle = middle_nodes(mesh);
  const bool is_hexahedral = mesh.elements.rows() == kHexahedronNodes;
  std::map<std::pair<int, int>, std::vector<Eigen::Vector3d>> normals;
  for (const auto& triangle : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.nodes.col(triangle[0]), b = mesh.nodes.col(triangle[1]),
                          c = mesh.nodes.col(triangle[2]);
    for (int i = 0; i < 3; ++i)
      normals[std::minmax(int{triangle[i]}, int{triangle[(i + 1) % 3]})].push_back(
          (b - a).cross(c - a).normalized());
  }
  std::vector<std::pair<int, int>> chosen;
  for (const auto& [edge, sides] : normals) {
    const int middles = middle[static_cast<std::size_t>(edge.first)] +
                        middle[static_cast<std::size_t>(edge.second)];
    if (middles > (is_hexahedral ? 0 : 1)) continue;
    const bool is_sharp = sides.size() != 2 || sides[0].dot(sides[1]) < crease;
    // Diagonals of a face between the midpoints of its edges are not parallel to any axis of its
    // box.
    const Eigen::Vector3d along =
        (mesh.nodes.col(edge.first) - mesh.nodes.col(edge.second)).cwiseAbs();
    const bool is_diagonal = is_hexahedral && along.maxCoeff() < 0.999 * along.norm();
    if (which == Edges::kSharp ? is_sharp : !is_diagonal) chosen.push_back(edge);
  }
  Eigen::Matrix2Xi columns(2, static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i)
    columns.col(static_cast<Eigen::Index>(i)) << chosen[i].first, chosen[i].second;
  return columns;
}

}  // namespace palpate::exporting
