#include "tools/export/material_law.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

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

}  // namespace

Eigen::Matrix3d corotational_first_stress(const Eigen::Matrix3d& F, const Stiffness& stiffness) {
  const Lame lame(stiffness);
  const Eigen::Matrix3d R = math::polar_rotation(F);
  const Eigen::Matrix3d strain = R.transpose() * F - Eigen::Matrix3d::Identity();
  return R * (2 * lame.mu * strain + lame.lambda * strain.trace() * Eigen::Matrix3d::Identity());
}

Eigen::Matrix3d cauchy_stress(Law law, const Eigen::Matrix3d& F, const Stiffness& stiffness) {
  const double J = std::max(F.determinant(), kSmallestVolumeShare);
  if (law == Law::kCorotational) return corotational_first_stress(F, stiffness) * F.transpose() / J;
  const Lame lame(stiffness);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  return (lame.mu * (F * F.transpose() - one) + lame.lambda * std::log(J) * one) / J;
}

}  // namespace palpate::exporting
