#include "tests/support/solid/strain_energy_tensor.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace palpate::support {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// (g_i - g_j) / (s_i - s_j) of g = tau / s; its limit for equal stretches.
double divided_difference(const solid::PrincipalStress& p, const Vector3d& s, int i, int j) {
  const double gap = s[i] - s[j];
  if (std::abs(gap) > 1e-6 * (s[i] + s[j])) return (p.stress[i] / s[i] - p.stress[j] / s[j]) / gap;
  const double at = 0.5 * (s[i] + s[j]);
  const double direct =
      0.5 * (p.tangent(i, i) + p.tangent(j, j)) - 0.5 * (p.stress[i] + p.stress[j]);
  return (direct - p.tangent(i, j)) / (at * at);
}

}  // namespace

bool respond_to_gradient(const solid::StrainEnergy& material, const Eigen::VectorXd& constants,
                         const Matrix3d& F, TensorStress& result) {
  if (!(F.determinant() > 0)) return false;
  const Eigen::JacobiSVD<Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d &U = svd.matrixU(), &V = svd.matrixV();
  const Vector3d s = svd.singularValues();
  solid::PrincipalStress p;
  material.evaluate(s.array().log(), constants, p);
  if (!p.stress.allFinite()) return false;

  // The nine directions U E_ij V', as columns of 9.
  const auto direction = [&](int i, int j) {
    const Matrix3d d = U.col(i) * V.col(j).transpose();
    return Eigen::Matrix<double, 9, 1>(Eigen::Map<const Eigen::Matrix<double, 9, 1>>(d.data()));
  };
  result.energy = p.energy;
  const Vector3d g = p.stress.cwiseQuotient(s);
  result.stress = U * g.asDiagonal() * V.transpose();
  result.tangent.setZero();
  result.by_constant.setZero(9, constants.size());
  for (int i = 0; i < 3; ++i) {
    result.by_constant += direction(i, i) * p.by_constant.row(i) / s[i];
    for (int j = 0; j < 3; ++j) {
      const double h = (p.tangent(i, j) - (i == j ? p.stress[i] : 0)) / (s[i] * s[j]);
      result.tangent += h * direction(i, i) * direction(j, j).transpose();
    }
  }
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 3; ++j) {
      const double stretch = divided_difference(p, s, i, j);
      const double turn = (g[i] + g[j]) / (s[i] + s[j]);
      const auto even = (direction(i, j) + direction(j, i)).eval();
      const auto odd = (direction(i, j) - direction(j, i)).eval();
      result.tangent +=
          0.5 * stretch * even * even.transpose() + 0.5 * turn * odd * odd.transpose();
    }
  return true;
}

}  // namespace palpate::support
