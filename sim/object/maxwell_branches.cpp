#include "sim/object/maxwell_branches.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::object {

MaxwellBranches::MaxwellBranches(const NeoHookean& material,
                                 const std::vector<MaxwellBranch>& branches, int elements)
    : material_(material) {
  if (branches.empty()) return;
  strain_ = Strains::Zero(6, elements * kGaussPoints);
  for (const MaxwellBranch& b : branches) {
    if (!(b.relative_modulus > 0) || !(b.relaxation_time > 0)) {
      throw std::invalid_argument("plant: a Maxwell branch needs modulus and time > 0");
    }
    Branch branch;
    branch.relative_modulus = b.relative_modulus;
    branch.relaxation_time = b.relaxation_time;
    branch.elastic = strain_;
    branches_.push_back(branch);
    relative_modulus_ += b.relative_modulus;
  }
}

void MaxwellBranches::set_step(double h) noexcept {
  for (Branch& branch : branches_) {
    const double x = h / branch.relaxation_time;
    branch.keep = std::exp(-x);
    branch.take = x > 0 ? -std::expm1(-x) / x : 1;
  }
}

double MaxwellBranches::add_stress(int element, int lane, const ElementGradients& F,
                                   ElementGradients& P) noexcept {
  double most_stretched = 1;
  for (int point = 0; point < kGaussPoints; ++point) {
    const int column = element * kGaussPoints + point;
    const Eigen::Matrix3d f = tensor_at(F, lane, point);
    const Eigen::Matrix3d C = f.transpose() * f;
    most_stretched = std::max(most_stretched, C.cwiseAbs().rowwise().sum().maxCoeff());
    Eigen::Matrix<double, 6, 1> strain;
    strain << 0.5 * (C(0, 0) - 1), 0.5 * (C(1, 1) - 1), 0.5 * (C(2, 2) - 1), 0.5 * C(0, 1),
        0.5 * C(1, 2), 0.5 * C(2, 0);
    const Eigen::Matrix<double, 6, 1> increment = strain - strain_.col(column);
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (Branch& branch : branches_) {
      auto elastic = branch.elastic.col(column);
      elastic = branch.keep * elastic + branch.take * increment;
      sum += branch.relative_modulus * elastic;
    }
    strain_.col(column) = strain;
    const double pressure = material_.lame * (sum[0] + sum[1] + sum[2]);
    const double mu2 = 2 * material_.shear_modulus;
    Eigen::Matrix3d S;
    S << mu2 * sum[0] + pressure, mu2 * sum[3], mu2 * sum[5],  //
        mu2 * sum[3], mu2 * sum[1] + pressure, mu2 * sum[4],   //
        mu2 * sum[5], mu2 * sum[4], mu2 * sum[2] + pressure;
    set_tensor(P, lane, point, tensor_at(P, lane, point) + f * S);
  }
  return most_stretched;
}

double MaxwellBranches::energy_density(int element, int point) const noexcept {
  double total = 0;
  for (const Branch& branch : branches_) {
    const auto a = branch.elastic.col(element * kGaussPoints + point);
    const double trace = a[0] + a[1] + a[2];
    const double square = a.head<3>().squaredNorm() + 2 * a.tail<3>().squaredNorm();
    total += branch.relative_modulus *
             (material_.shear_modulus * square + 0.5 * material_.lame * trace * trace);
  }
  return total;
}

}  // namespace palpate::object
