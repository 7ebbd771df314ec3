#include "sim/object/neo_hookean_solid.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "sim/object/quadratic_shape.hpp"

namespace palpate::object {
namespace {

/// out (kRows x 3) = a (kRows x kDepth) b (kDepth x 3, its columns kStride apart), in blocks of
/// rows whose sums stay in registers.
template <int kRows, int kDepth, int kStride, int kBlock>
inline void multiply(const double* a, const double* b, double* out) noexcept {
  static_assert(kRows % kBlock == 0);
  for (int row = 0; row < kRows; row += kBlock) {
    double x[kBlock] = {};
    double y[kBlock] = {};
    double z[kBlock] = {};
    for (int k = 0; k < kDepth; ++k) {
      const double* column = a + k * kRows + row;
      for (int r = 0; r < kBlock; ++r) x[r] += column[r] * b[k];
      for (int r = 0; r < kBlock; ++r) y[r] += column[r] * b[k + kStride];
      for (int r = 0; r < kBlock; ++r) z[r] += column[r] * b[k + 2 * kStride];
    }
    std::copy(x, x + kBlock, out + row);
    std::copy(y, y + kBlock, out + row + kRows);
    std::copy(z, z + kBlock, out + row + 2 * kRows);
  }
}

}  // namespace

NeoHookean NeoHookean::from_young(double young_modulus, double poisson_ratio) {
  if (!(young_modulus > 0) || !(poisson_ratio >= 0 && poisson_ratio < 0.5)) {
    throw std::invalid_argument("plant: needs young_modulus > 0 and 0 <= poisson_ratio < 0.5");
  }
  return {young_modulus / (2 * (1 + poisson_ratio)),
          young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio))};
}

NeoHookeanSolid::NeoHookeanSolid(const HexahedralGrid& grid, const NeoHookean& material,
                                 double viscosity)
    : material_(material), viscosity_(viscosity), elements_(grid.elements()) {
  if (!(viscosity >= 0)) throw std::invalid_argument("plant: viscosity must not be negative");
  const double node = std::sqrt(0.6);
  const std::array<double, 3> abscissas{-node, 0, node};
  const std::array<double, 3> shares{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const Eigen::Vector3d size = grid.element_size();
  for (int point = 0; point < kPoints; ++point) {
    const int g = point % 27;
    const std::array<int, 3> at{g % 3, g / 3 % 3, g / 9};
    const QuadraticShape shape[3] = {QuadraticShape(abscissas[at[0]]),
                                     QuadraticShape(abscissas[at[1]]),
                                     QuadraticShape(abscissas[at[2]])};
    weights_[point] = point < 27 ? size.prod() * shares[at[0]] * shares[at[1]] * shares[at[2]] : 0;
    for (int a = 0; a < 27; ++a) {
      const std::array<int, 3> index{a % 3, a / 3 % 3, a / 9};
      for (int axis = 0; axis < 3; ++axis) {
        double slope = 2 / size[axis];
        for (int d = 0; d < 3; ++d) {
          slope *= d == axis ? shape[d].slope[index[d]] : shape[d].value[index[d]];
        }
        gradients_(axis * kPoints + point, a) = slope;
      }
    }
  }
  divergence_.setZero();
  for (int axis = 0; axis < 3; ++axis) {
    for (int point = 0; point < kPoints; ++point) {
      const int row = axis * kPoints + point;
      divergence_.col(row).head<27>() = -weights_[point] * gradients_.row(row).transpose();
    }
  }
}

NeoHookeanSolid::Corners NeoHookeanSolid::gather(const Eigen::Matrix3Xd& values,
                                                 int element) const noexcept {
  Corners corners;
  for (int a = 0; a < 27; ++a) corners.row(a) = values.col(elements_(a, element)).transpose();
  corners.row(27).setZero();
  return corners;
}

double NeoHookeanSolid::first_piola(const Gradients& F, Gradients& P) const noexcept {
  using Points = Eigen::Array<double, kPoints, 1>;
  const double mu = material_.shear_modulus;
  const double lambda = material_.lame;
  const auto f = [&F](int i, int j) { return F.col(i).segment<kPoints>(j * kPoints).array(); };

  Gradients cofactor;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3;
    const int i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      cofactor.col(i).segment<kPoints>(j * kPoints).array() =
          f(i1, j1) * f(i2, j2) - f(i1, j2) * f(i2, j1);
    }
  }
  const auto c = [&cofactor](int i, int j) {
    return cofactor.col(i).segment<kPoints>(j * kPoints).array();
  };
  const Points J = f(0, 0) * c(0, 0) + f(0, 1) * c(0, 1) + f(0, 2) * c(0, 2);
  const Points guarded = J.max(kLeastVolumeRatio);
  const Points slope = guarded.inverse();
  const Points log_J = guarded.log() + (J - guarded) * slope;
  const Points pressure = (lambda * log_J - mu) * slope;
  Points inverse_squared = Points::Zero();  // |F^-1|^2
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      P.col(i).segment<kPoints>(j * kPoints).array() = mu * f(i, j) + pressure * c(i, j);
      inverse_squared += (c(i, j) * slope).square();
    }
  }
  // A rank-one strain across the most compressed direction n meets the modulus
  // mu + (mu + lambda (1 - l)) |F^-T n|^2; at rest the other two directions add 2 to |F^-1|^2.
  const Points modulus = mu + (mu + lambda * (1 - log_J)) * (inverse_squared - 2).max(1);
  return std::max(1.0, modulus.maxCoeff() / (2 * mu + lambda));
}

void NeoHookeanSolid::add_viscous_stress(const Gradients& F, const Gradients& F_rate,
                                         Gradients& P) const noexcept {
  for (int point = 0; point < kPoints; ++point) {
    Eigen::Matrix3d f, rate;
    for (int j = 0; j < 3; ++j) {
      f.col(j) = F.row(j * kPoints + point).transpose();
      rate.col(j) = F_rate.row(j * kPoints + point).transpose();
    }
    const Eigen::Matrix3d half = f.transpose() * rate;
    const Eigen::Matrix3d stress = viscosity_ * f * (half + half.transpose());
    for (int j = 0; j < 3; ++j) P.row(j * kPoints + point) += stress.col(j).transpose();
  }
}

double NeoHookeanSolid::add_forces(const Eigen::Matrix3Xd& positions,
                                   const Eigen::Matrix3Xd& velocities,
                                   Eigen::Matrix3Xd& forces) const noexcept {
  double stiffening = 1;
  for (int e = 0; e < elements_.cols(); ++e) {
    Gradients F, P;
    const Corners corners = gather(positions, e);
    multiply<kGradients, 27, kNodes, 12>(gradients_.data(), corners.data(), F.data());
    stiffening = std::max(stiffening, first_piola(F, P));
    if (viscosity_ > 0) {
      Gradients F_rate;
      const Corners rates = gather(velocities, e);
      multiply<kGradients, 27, kNodes, 12>(gradients_.data(), rates.data(), F_rate.data());
      add_viscous_stress(F, F_rate, P);
    }
    Corners nodal;
    multiply<kNodes, kGradients, kGradients, 4>(divergence_.data(), P.data(), nodal.data());
    for (int a = 0; a < 27; ++a) forces.col(elements_(a, e)) += nodal.row(a).transpose();
  }
  return stiffening;
}

double NeoHookeanSolid::energy(const Eigen::Matrix3Xd& positions) const noexcept {
  const double mu = material_.shear_modulus;
  const double lambda = material_.lame;
  double total = 0;
  for (int e = 0; e < elements_.cols(); ++e) {
    Gradients F;
    const Corners corners = gather(positions, e);
    multiply<kGradients, 27, kNodes, 12>(gradients_.data(), corners.data(), F.data());
    for (int point = 0; point < 27; ++point) {
      Eigen::Matrix3d f;
      for (int j = 0; j < 3; ++j) f.col(j) = F.row(j * kPoints + point).transpose();
      const double J = f.col(0).dot(f.col(1).cross(f.col(2)));
      const double guarded = std::max(J, kLeastVolumeRatio);
      const double log_J = std::log(guarded) + (J - guarded) / guarded;
      total += weights_[point] *
               (0.5 * mu * (f.squaredNorm() - 3) - mu * log_J + 0.5 * lambda * log_J * log_J);
    }
  }
  return total;
}

}  // namespace palpate::object
