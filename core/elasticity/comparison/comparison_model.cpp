#include "core/elasticity/comparison/comparison_model.hpp"

#include <cmath>
#include <utility>

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;

Body checked(Body body) {
  body.check();
  return body;
}

}  // namespace

ComparisonModel::ComparisonModel(Body body)
    : body_(checked(std::move(body))),
      held_(body_),
      gravity_(body_.gravity_O),
      x_(body_.mesh.nodes),
      x_begin_(x_) {
  for (Matrix3Xd* m : {&loads_, &v_, &v_begin_, &forces_, &forces_begin_}) {
    m->setZero(3, x_.cols());
  }
}

void ComparisonModel::prepare() {
  reset();
  gravity_ = body_.gravity_O;
}

void ComparisonModel::reset() noexcept {
  x_ = body_.mesh.nodes;
  v_.setZero();
  loads_.setZero();
  forces_.setZero();
  residual_ = 0;
  held_.release_all();
}

StepReport ComparisonModel::step(double dt) noexcept {
  StepReport report;
  report.residual = residual_;
  if (!(dt > 0) || !std::isfinite(dt) || !loads_.allFinite() || !gravity_.allFinite() ||
      !held_.poses_are_finite()) {
    return report;
  }
  x_begin_ = x_;
  v_begin_ = v_;
  forces_begin_ = forces_;
  const StepReport done = advance(dt);
  if (done.status == StepStatus::kFailed || !std::isfinite(done.residual) || !x_.allFinite() ||
      !v_.allFinite() || !forces_.allFinite()) {
    x_ = x_begin_;
    v_ = v_begin_;
    forces_ = forces_begin_;
    return report;
  }
  held_.commit();
  residual_ = done.residual;
  return done;
}

math::Wrench ComparisonModel::reaction(int grasp) const noexcept {
  return held_.reaction(grasp, x_, forces_);
}

bool ComparisonModel::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (positions.cols() != x_.cols() || velocities.cols() != x_.cols() || !positions.allFinite() ||
      !velocities.allFinite()) {
    return false;
  }
  x_ = positions;
  v_ = velocities;
  forces_.setZero();
  for (int node : body_.fixed_nodes) {
    x_.col(node) = body_.mesh.nodes.col(node);
    v_.col(node).setZero();
  }
  return true;
}

}  // namespace palpate::elasticity
