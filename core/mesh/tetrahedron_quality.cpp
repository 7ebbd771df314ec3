#include "core/mesh/tetrahedron_quality.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/report.hpp"

namespace palpate::mesh {
namespace {

using Corners = Eigen::Matrix<double, 3, 4>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Eigen::Vector3d;

/// L of D = L L^T, Hooke's law for E = 1.
Matrix6d stiffness_root() {
  constexpr double kNu = 0.3, kScale = 1 / ((1 + kNu) * (1 - 2 * kNu));
  Matrix6d D = Matrix6d::Zero();
  D.topLeftCorner<3, 3>().setConstant(kScale * kNu);
  D.topLeftCorner<3, 3>().diagonal().setConstant(kScale * (1 - kNu));
  D.bottomRightCorner<3, 3>().diagonal().setConstant(0.5 / (1 + kNu));
  return D.llt().matrixL();
}

/// Largest eigenvalue of V B^T D B, equal to that of the smaller V L^T B B^T L, divided by V^(1/3).
double largest_stiffness(const Corners& x) {
  static const Matrix6d kRoot = stiffness_root();
  Eigen::Matrix3d edges;
  for (int i = 0; i < 3; ++i) edges.col(i) = x.col(i + 1) - x.col(0);
  const double volume = std::abs(edges.determinant()) / 6;
  Eigen::Matrix<double, 3, 4> gradients;
  gradients.rightCols<3>() = edges.inverse().transpose();
  gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
  Eigen::Matrix<double, 6, 12> B = Eigen::Matrix<double, 6, 12>::Zero();
  for (int a = 0; a < 4; ++a) {
    const Vector3d g = gradients.col(a);
    B.block<6, 3>(0, 3 * a) << g.x(), 0, 0, 0, g.y(), 0, 0, 0, g.z(), g.y(), g.x(), 0, 0, g.z(),
        g.y(), g.z(), 0, g.x();
  }
  const Matrix6d product = kRoot.transpose() * (B * B.transpose()) * kRoot;
  if (!product.allFinite() || !(volume > 0)) return std::numeric_limits<double>::infinity();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(product, Eigen::EigenvaluesOnly);
  return volume * solver.eigenvalues()[5] / std::cbrt(volume);
}

double regular_stiffness() {
  Corners x;
  x << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  return largest_stiffness(x);
}

}  // namespace

TetrahedronQuality measure(const TetrahedralMesh& mesh, int t) {
  static const double kRegular = regular_stiffness();
  Corners x;
  for (int i = 0; i < 4; ++i) x.col(i) = mesh.nodes.col(mesh.tetrahedra(i, t));
  TetrahedronQuality quality;
  quality.volume = volume(mesh, t);
  for (const auto& [a, b] : kTetrahedronEdges) {
    const double length = (x.col(b) - x.col(a)).norm();
    quality.longest_edge = std::max(quality.longest_edge, length);
  }
  quality.stiffness = std::numeric_limits<double>::infinity();
  // same criterion for flat elements as check()
  if (!(std::abs(quality.volume) > 1e-12 * std::pow(quality.longest_edge, 3))) return quality;

  quality.smallest_angle = EIGEN_PI;
  for (const auto& [a, b] : kTetrahedronEdges) {
    int others[2], k = 0;
    for (int i = 0; i < 4; ++i) {
      if (i != a && i != b) others[k++] = i;
    }
    const Vector3d axis = x.col(b) - x.col(a);
    const Vector3d u = axis.cross(x.col(others[0]) - x.col(a));
    const Vector3d v = axis.cross(x.col(others[1]) - x.col(a));
    const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
    quality.smallest_angle = std::min(quality.smallest_angle, angle);
    quality.largest_angle = std::max(quality.largest_angle, angle);
  }
  double largest_product = 0;
  for (int i = 0; i < 4; ++i) {
    double product = 1;
    for (int j = 0; j < 4; ++j) product *= i == j ? 1 : (x.col(j) - x.col(i)).norm();
    largest_product = std::max(largest_product, product);
  }
  quality.scaled_jacobian = 6 * std::sqrt(2.0) * std::abs(quality.volume) / largest_product;
  quality.radius_ratio = radius_ratio(mesh, t);
  quality.stiffness = largest_stiffness(x) / kRegular;
  return quality;
}

}  // namespace palpate::mesh
