#include "core/math/polar.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace palpate::math {
namespace {

/// Vector a with [a]x = B - B^T.
Eigen::Vector3d skew_part(const Eigen::Matrix3d& B) {
  return {B(2, 1) - B(1, 2), B(0, 2) - B(2, 0), B(1, 0) - B(0, 1)};
}

/// tr(S) I - S with S the symmetric part of B: the negative second derivative of tr(R^T F).
Eigen::Matrix3d curvature(const Eigen::Matrix3d& B) {
  return B.trace() * Eigen::Matrix3d::Identity() - 0.5 * (B + B.transpose());
}

Eigen::Matrix3d rotation_by_svd(const Eigen::Matrix3d& F) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  // singular values are sorted: the smallest takes the sign
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  return U * svd.matrixV().transpose();
}

/// Newton's method for the maximum of tr(R^T F) over rotations; false if it is not safe. A
/// stationary point with positive curvature is the global maximum, because the trace is a quadratic
/// form on the unit sphere of quaternions.
bool rotation_by_newton(const Eigen::Matrix3d& F, Eigen::Quaterniond& q) {
  constexpr int kMaxSteps = 12;
  // Convergence is cubic: after a step this small the error is below rounding.
  constexpr double kSmallStep = 1e-5;
  // Smallest determinant of the curvature, relative to its mean eigenvalue cubed.
  constexpr double kLeastCurvature = 1e-4;
  for (int k = 0; k < kMaxSteps; ++k) {
    const Eigen::Matrix3d B = q.toRotationMatrix().transpose() * F;
    const Eigen::Matrix3d H = curvature(B);
    const double mean = H.trace() / 3;
    const double minor = H(0, 0) * H(1, 1) - H(0, 1) * H(0, 1);
    const double determinant = H.determinant();
    if (!(H(0, 0) > 0 && minor > 0 && determinant > kLeastCurvature * mean * mean * mean)) {
      return false;
    }
    const Eigen::Vector3d step = H.inverse() * skew_part(B);
    q = (q * Eigen::Quaterniond(1, 0.5 * step.x(), 0.5 * step.y(), 0.5 * step.z())).normalized();
    if (step.squaredNorm() < kSmallStep * kSmallStep) return true;
  }
  return false;
}

}  // namespace

Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& F, Eigen::Quaterniond& warm) noexcept {
  if (!F.allFinite()) {
    warm.setIdentity();
    return Eigen::Matrix3d::Identity();
  }
  if (rotation_by_newton(F, warm)) return warm.toRotationMatrix();
  warm = Eigen::Quaterniond(rotation_by_svd(F)).normalized();
  return warm.toRotationMatrix();
}

Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& F) noexcept {
  Eigen::Quaterniond start = Eigen::Quaterniond::Identity();
  return polar_rotation(F, start);
}

Eigen::Matrix3d polar_spin(const Eigen::Matrix3d& R, const Eigen::Matrix3d& F) noexcept {
  const Eigen::Matrix3d B = R.transpose() * F;
  const Eigen::Matrix3d H = curvature(B);
  const double floor = 1e-6 * B.norm();
  const double mean = H.trace() / 3;
  if (H.determinant() > 1e-3 * mean * mean * mean) return H.inverse();
  // Near a flip: bound the inverse for each eigenvalue.
  if (!(floor > 0)) return Eigen::Matrix3d::Zero();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(H);
  const Eigen::Vector3d inverse = eigen.eigenvalues().cwiseMax(floor).cwiseInverse();
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace palpate::math
