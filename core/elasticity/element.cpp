#include "core/elasticity/element.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "core/math/polar.hpp"

namespace palpate::elasticity {

using mesh::kTetrahedronEdges;

Eigen::Matrix<double, 3, 4> barycentric_gradients(const Eigen::Matrix<double, 3, 4>& corners) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = corners.col(k + 1) - corners.col(0);
  Eigen::Matrix<double, 3, 4> g;
  g.rightCols<3>() = edges.inverse().transpose();
  g.col(0) = -g.rightCols<3>().rowwise().sum();
  return g;
}

Lame lame(const Material& material) {
  const double e = material.young_modulus, nu = material.poisson_ratio;
  return {e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))};
}

ElementMaterials element_materials(const Body& body) {
  std::vector<Lame> all;
  for (int e = 0; e < body.mesh.element_count(); ++e) all.push_back(lame(body.material_of(e)));
  return {std::move(all), body.law};
}

double tetrahedron_volume(const Eigen::Matrix<double, 3, 4>& corners) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = corners.col(k + 1) - corners.col(0);
  return edges.determinant() / 6;
}

template <>
std::array<Eigen::Matrix<double, 3, 4>, 1> Tetrahedron<4>::gradients(
    const Eigen::Matrix<double, 3, 4>& corners) {
  return {barycentric_gradients(corners)};
}

template <>
std::array<Eigen::Matrix<double, 3, 10>, 4> Tetrahedron<10>::gradients(
    const Eigen::Matrix<double, 3, 4>& corners) {
  const Eigen::Matrix<double, 3, 4> g = barycentric_gradients(corners);
  std::array<Gradients, 4> all;
  for (int p = 0; p < 4; ++p) {
    Eigen::Vector4d b = Eigen::Vector4d::Constant(kFar);
    b(p) = kNear;
    for (int a = 0; a < 4; ++a) all[p].col(a) = (4 * b(a) - 1) * g.col(a);
    for (int m = 0; m < 6; ++m) {
      const auto [i, j] = kTetrahedronEdges[m];
      all[p].col(4 + m) = 4 * (b(i) * g.col(j) + b(j) * g.col(i));
    }
  }
  return all;
}

template <>
Eigen::Matrix4d Tetrahedron<4>::mass_shares() {
  return (Eigen::Matrix4d::Ones() + Eigen::Matrix4d::Identity()) / 20;
}

template <>
Eigen::Matrix<double, 10, 10> Tetrahedron<10>::mass_shares() {
  Eigen::Matrix<double, 10, 10> m;
  m.topLeftCorner<4, 4>().setOnes();
  m.diagonal().head<4>().setConstant(6);
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = kTetrahedronEdges[k];
    for (int corner = 0; corner < 4; ++corner) {
      m(corner, 4 + k) = m(4 + k, corner) = (corner == i || corner == j) ? -4 : -6;
    }
    for (int other = 0; other < 6; ++other) {
      const auto [p, q] = kTetrahedronEdges[other];
      const int shared = (p == i || p == j) + (q == i || q == j);
      m(4 + k, 4 + other) = shared == 2 ? 32 : shared == 1 ? 16 : 8;
    }
  }
  return m / 420;
}

template <>
Eigen::Vector4d Tetrahedron<4>::volume_shares() {
  return Eigen::Vector4d::Constant(0.25);
}

template <>
Eigen::Matrix<double, 10, 1> Tetrahedron<10>::volume_shares() {
  Eigen::Matrix<double, 10, 1> shares;
  shares << Eigen::Vector4d::Constant(-0.05), Eigen::Matrix<double, 6, 1>::Constant(0.2);
  return shares;
}

Eigen::Matrix3d point_twist(const Eigen::Matrix3d& S, const Lame& lame, Tangent kind) {
  if (kind == Tangent::kWarped) return lame.mu * Eigen::Matrix3d::Identity();
  // With H = tr(S) I - S and v = vee(R^T dF - dF^T R) the rotation changes by R (H^-1 v); the
  // resulting part of dP is -(2 mu - lambda tr(S - I)) times H^-1 applied to the twists of the
  // point.
  const double factor = 2 * lame.mu - lame.lambda * (S.trace() - 3);
  const Eigen::Matrix3d H = S.trace() * Eigen::Matrix3d::Identity() - S;
  if (kind == Tangent::kExact && H(0, 0) > 0 && H.determinant() > kSmallestTurnStiffness &&
      H(0, 0) * H(1, 1) > H(0, 1) * H(0, 1)) {
    return factor * H.inverse();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(H);
  Eigen::Vector3d values;
  for (int i = 0; i < 3; ++i) {
    values(i) = factor / std::max(eigen.eigenvalues()(i), 1e-9);
    if (kind == Tangent::kSemidefinite) values(i) = std::min(values(i), lame.mu);
  }
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

PointTangent point_tangent(const Eigen::Matrix3d& F, const Lame& lame, Tangent kind,
                           double viscous) {
  PointTangent t;
  t.rotation = math::polar_rotation(F);
  t.s = 2 * lame.mu * (1 + viscous);
  t.l = lame.lambda * (1 + viscous);
  const Eigen::Matrix3d B = t.rotation.transpose() * F;
  Eigen::Matrix3d twist = point_twist(0.5 * (B + B.transpose()), lame, kind);
  twist.diagonal().array() += viscous * lame.mu;
  t.twist = t.rotation * twist * t.rotation.transpose();
  return t;
}

}  // namespace palpate::elasticity
