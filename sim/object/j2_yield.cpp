#include "sim/object/j2_yield.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::object {
namespace {

constexpr int kMostIterations = 60;
constexpr double kTolerance = 1e-12;          // of the yield stress
constexpr double kLeastVolumeRatio = 0.2;     // of a point that may flow
constexpr double kMostSquareStretch = 9;      // plastic
constexpr double kLeastSquareStretch = 1e-6;  // of a severely compressed point
const double kRootTwoThirds = std::sqrt(2.0 / 3);

/// Principal values of dev tau over mu.
Eigen::Vector3d stress_deviator(const Eigen::Vector3d& log_stretch) noexcept {
  const Eigen::Vector3d squares = (2 * log_stretch).array().exp();
  return squares.array() - squares.mean();
}

/// Upper bound of the square of the largest singular value; 1 for a rotation.
double square_bound(const Eigen::Matrix3d& m) noexcept {
  const Eigen::Matrix3d square = m * m.transpose();
  return square.cwiseAbs().rowwise().sum().maxCoeff();
}

}  // namespace

J2Yield::J2Yield(const NeoHookean& material, const Yield& yield, int elements)
    : material_(material), yield_(yield) {
  if (!(yield.stress > 0) || !(yield.hardening >= 0)) {
    throw std::invalid_argument("plant: yield needs stress > 0 and hardening >= 0");
  }
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  inverse_ = identity.reshaped().replicate(1, elements * kGaussPoints);
  strain_ = Eigen::VectorXd::Zero(elements * kGaussPoints);
  stiffening_ = Eigen::VectorXd::Ones(elements * kGaussPoints);
}

Eigen::Matrix3d J2Yield::plastic_inverse(int element, int point) const noexcept {
  return Eigen::Map<const Eigen::Matrix3d>(inverse_.col(element * kGaussPoints + point).data());
}

/// Step length back along `direction` that puts the stress on the yield surface: Newton's method
/// bracketed in [0, bound], at whose end the deviator is zero.
double J2Yield::flow_length(const Eigen::Vector3d& log_stretch, const Eigen::Vector3d& direction,
                            double bound, double strain) const noexcept {
  const double mu = material_.shear_modulus;
  double low = 0, high = bound, length = 0;
  for (int i = 0; i < kMostIterations; ++i) {
    const Eigen::Vector3d at = log_stretch - length * direction;
    const Eigen::Vector3d deviator = stress_deviator(at);
    const double norm = std::max(deviator.norm(), 1e-300);
    const double limit =
        kRootTwoThirds * (yield_.stress + yield_.hardening * (strain + kRootTwoThirds * length));
    const double excess = mu * norm - limit;
    if (std::abs(excess) <= kTolerance * yield_.stress) break;
    (excess > 0 ? low : high) = length;
    const Eigen::Vector3d squares = (2 * at).array().exp();
    const double slope =
        -2 * mu * deviator.dot(squares.cwiseProduct(direction)) / norm - 2.0 / 3 * yield_.hardening;
    const double next = length - excess / slope;
    length = next > low && next < high ? next : 0.5 * (low + high);
  }
  return length;
}

double J2Yield::flow(int element, int lane, ElementGradients& F) noexcept {
  double stiffening = 1;
  for (int point = 0; point < kGaussPoints; ++point) {
    const int column = element * kGaussPoints + point;
    Eigen::Matrix3d elastic = tensor_at(F, lane, point) * plastic_inverse(element, point);
    const Eigen::Matrix3d C = elastic.transpose() * elastic;
    const double trace = C.trace();
    const double square = std::max(0.0, C.squaredNorm() - trace * trace / 3);  // |dev b_e|^2
    const double limit = kRootTwoThirds * (yield_.stress + yield_.hardening * strain_[column]);
    if (material_.shear_modulus * std::sqrt(square) > limit &&
        elastic.determinant() > kLeastVolumeRatio) {
      // In closed form: when the whole body flows this dominates the cost of a step, and an error
      // of the axes of the order of the square root of rounding rotates the flow by no more.
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
      axes.computeDirect(C);
      const Eigen::Vector3d log_stretch =
          0.5 * axes.eigenvalues().cwiseMax(kLeastSquareStretch).array().log();
      Eigen::Vector3d direction = log_stretch.array() - log_stretch.mean();
      const double bound = direction.norm();
      direction /= std::max(bound, 1e-300);
      const double length = flow_length(log_stretch, direction, bound, strain_[column]);
      const Eigen::Vector3d back = (-length * direction).array().exp();
      const Eigen::Matrix3d shrink =
          axes.eigenvectors() * back.asDiagonal() * axes.eigenvectors().transpose();
      const Eigen::Matrix3d inverse = plastic_inverse(element, point) * shrink;
      if (square_bound(inverse) <= kMostSquareStretch) {
        inverse_.col(column) = inverse.reshaped();
        strain_[column] += kRootTwoThirds * length;
        stiffening_[column] = square_bound(inverse);
        elastic = elastic * shrink;
      }
    }
    stiffening = std::max(stiffening, stiffening_[column]);
    set_tensor(F, lane, point, elastic);
  }
  return stiffening;
}

void J2Yield::take_out(int element, int lane, ElementGradients& F) const noexcept {
  for (int point = 0; point < kGaussPoints; ++point) {
    set_tensor(F, lane, point, tensor_at(F, lane, point) * plastic_inverse(element, point));
  }
}

void J2Yield::pull_back(int element, int lane, ElementGradients& P) const noexcept {
  for (int point = 0; point < kGaussPoints; ++point) {
    set_tensor(P, lane, point,
               tensor_at(P, lane, point) * plastic_inverse(element, point).transpose());
  }
}

}  // namespace palpate::object
