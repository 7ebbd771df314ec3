#include "sim/object/neo_hookean_solid.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "sim/object/quadratic_shape.hpp"

namespace palpate::object {
namespace {

/// Where the three Gauss points divide an edge.
const std::array<double, 3> kGaussShare{0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};

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

NeoHookeanSolid::NeoHookeanSolid(const HexahedralGrid& grid, const SolidOptions& options)
    : material_(options.material),
      viscosity_(options.viscosity),
      elements_(grid.elements()),
      maxwell_(options.material, options.maxwell, grid.element_count()) {
  if (!(viscosity_ >= 0)) throw std::invalid_argument("plant: viscosity must not be negative");
  if (options.yield) yield_ = J2Yield(material_, *options.yield, grid.element_count());
  const std::array<double, 3> shares{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const Eigen::Vector3d size = grid.element_size();
  for (int point = 0; point < kPoints; ++point) {
    const int g = point % 27;
    const std::array<int, 3> at{g % 3, g / 3 % 3, g / 9};
    const QuadraticShape shape[3] = {QuadraticShape(2 * kGaussShare[at[0]] - 1),
                                     QuadraticShape(2 * kGaussShare[at[1]] - 1),
                                     QuadraticShape(2 * kGaussShare[at[2]] - 1)};
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
  find_stiffness(grid, options.regions);
}

void NeoHookeanSolid::find_stiffness(const HexahedralGrid& grid,
                                     const std::vector<ModulusRegion>& regions) {
  if (regions.empty()) return;
  stiffness_ = Eigen::ArrayXXd::Ones(kPoints, grid.element_count());
  for (const ModulusRegion& region : regions) {
    if (!(region.young_modulus > 0)) {
      throw std::invalid_argument("plant: the young_modulus of a region must be positive");
    }
    bool found = false;
    for (int e = 0; e < grid.element_count(); ++e) {
      const Eigen::Vector3d lower = grid.nodes().col(elements_(0, e));
      for (int point = 0; point < 27; ++point) {
        const Eigen::Vector3d at(kGaussShare[point % 3], kGaussShare[point / 3 % 3],
                                 kGaussShare[point / 9]);
        if (!region.box.contains(lower + at.cwiseProduct(grid.element_size()))) continue;
        stiffness_(point, e) = region.young_modulus / material_.young_modulus();
        found = true;
      }
    }
    if (!found) throw std::invalid_argument("plant: a region of the material holds no point");
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
  for (int point = 0; point < kGaussPoints; ++point) {
    const Eigen::Matrix3d f = tensor_at(F, point);
    const Eigen::Matrix3d half = f.transpose() * tensor_at(F_rate, point);
    const Eigen::Matrix3d stress = viscosity_ * f * (half + half.transpose());
    for (int j = 0; j < 3; ++j) P.row(j * kPoints + point) += stress.col(j).transpose();
  }
}

double NeoHookeanSolid::add_forces(const Eigen::Matrix3Xd& positions,
                                   const Eigen::Matrix3Xd& velocities, double h,
                                   Eigen::Matrix3Xd& forces) noexcept {
  maxwell_.set_step(h);
  double stiffening = 1;
  for (int e = 0; e < elements_.cols(); ++e) {
    Gradients F, P;
    const Corners corners = gather(positions, e);
    multiply<kGradients, 27, kNodes, 12>(gradients_.data(), corners.data(), F.data());
    if (yield_.empty()) {
      stiffening = std::max(stiffening, first_piola(F, P));
    } else {
      Gradients elastic = F;
      const double plastic = yield_.flow(e, elastic);
      stiffening = std::max(stiffening, plastic * first_piola(elastic, P));
      yield_.pull_back(e, P);
    }
    if (!maxwell_.empty()) stiffening = std::max(stiffening, maxwell_.add_stress(e, F, P));
    if (stiffness_.size() > 0) {
      for (int j = 0; j < 3; ++j)
        P.middleRows<kPoints>(j * kPoints).array().colwise() *= stiffness_.col(e);
    }
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
    if (!yield_.empty()) yield_.take_out(e, F);
    for (int point = 0; point < kGaussPoints; ++point) {
      const Eigen::Matrix3d f = tensor_at(F, point);
      const double J = f.col(0).dot(f.col(1).cross(f.col(2)));
      const double guarded = std::max(J, kLeastVolumeRatio);
      const double log_J = std::log(guarded) + (J - guarded) / guarded;
      const double stiffness = stiffness_.size() > 0 ? stiffness_(point, e) : 1;
      const double elastic =
          0.5 * mu * (f.squaredNorm() - 3) - mu * log_J + 0.5 * lambda * log_J * log_J;
      total += weights_[point] * stiffness * (elastic + maxwell_.energy_density(e, point));
    }
  }
  return total;
}

}  // namespace palpate::object
