#include "core/elasticity/incremental/nodal_motion.hpp"

#include <algorithm>

namespace palpate::elasticity {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

NodalMotion::NodalMotion(const NumberedBody& body, bool dynamic)
    : body_(body),
      dynamic_(dynamic),
      x_(body.rest),
      v_(NodalField::Zero(4, body.node_count())),
      x_begin_(body.rest),
      x_expected_(v_),
      prediction_error_(v_),
      positions_(body.body.mesh.nodes),
      velocities_(Matrix3Xd::Zero(3, body.node_count())) {}

void NodalMotion::complete_prediction(bool improve) noexcept {
  x_expected_ = x_;
  if (improve) x_ += persistence_ * prediction_error_;
}

/// The error is that of velocities or sensitivity: changes of velocity, or effects of changing
/// loads. Its persistence is the factor by which the last error would have predicted this one best.
void NodalMotion::finish_step(double dt) noexcept {
  if (dynamic_) v_ = (x_ - x_begin_) / dt;
  double alike = 0, before = 0;
  for (int k = 0; k < body_.pattern.size(); ++k) {
    const Vector3d error = (x_.col(k) - x_expected_.col(k)).head<3>();
    auto last = prediction_error_.col(k).head<3>();
    if (k < body_.pattern.interior_size()) {
      alike += error.dot(last);
      before += last.squaredNorm();
    }
    last = error;
  }
  persistence_ = before > 0 ? std::clamp(alike / before, 0.0, 1.0) : 0;
}

void NodalMotion::stop() noexcept {
  x_begin_ = x_;
  v_.setZero();
  prediction_error_.setZero();
}

void NodalMotion::publish() noexcept {
  for (int node = 0; node < positions_.cols(); ++node) {
    positions_.col(node) = x_.col(body_.numbering[node]).head<3>();
    velocities_.col(node) = v_.col(body_.numbering[node]).head<3>();
  }
}

void NodalMotion::reset() noexcept {
  x_ = body_.rest;
  v_.setZero();
  prediction_error_.setZero();
  publish();
}

bool NodalMotion::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (positions.cols() != x_.cols() || velocities.cols() != x_.cols() || !positions.allFinite() ||
      !velocities.allFinite()) {
    return false;
  }
  for (int node = 0; node < positions.cols(); ++node) {
    const int k = body_.numbering[node];
    const bool fixed = k >= body_.pattern.size();
    x_.col(k).head<3>() =
        fixed ? Vector3d(body_.body.mesh.nodes.col(node)) : Vector3d(positions.col(node));
    v_.col(k).head<3>() = fixed || !dynamic_ ? Vector3d::Zero() : Vector3d(velocities.col(node));
  }
  prediction_error_.setZero();
  publish();
  return true;
}

}  // namespace palpate::elasticity
