#include "tests/bench/core/elasticity/baseline_model.hpp"

#include "tests/bench/core/elasticity/samples.hpp"

namespace palpate::bench {

BaselineModel::BaselineModel(const elasticity::Body& body, Solver solver, bool dynamic)
    : body_(body), dynamic_(dynamic), system_(body) {
  if (solver == Solver::kCholmod) {
    cholmod_.emplace(system_.matrix());
  } else {
    pcg_.emplace(system_.size());
  }
  x_ = x_begin_ = x_inertial_ = body.mesh.nodes;
  v_ = no_loads_ = Eigen::Matrix3Xd::Zero(3, x_.cols());
  dx_ = Eigen::Matrix4Xd::Zero(4, system_.size());
}

void BaselineModel::restore(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& v) {
  x_ = x;
  v_ = v;
  system_.assemble(x_, x_, no_loads_, 0);
}

void BaselineModel::predict(double dt, const math::Pose& clamp) {
  inertia_ = dynamic_ ? 1 / (dt * dt) + body_.damping.mass_factor / dt : 0;
  x_begin_ = x_;
  if (dynamic_) {
    x_inertial_ = x_begin_ + v_ * (1 / (dt * inertia_));
    x_ += dt * v_;
  }
  const math::Pose moved = clamp * body_.grasps[0].X_OG_rest.inverse();
  for (int i : body_.grasps[0].nodes) x_.col(i) = moved * body_.mesh.nodes.col(i);
}

bool BaselineModel::correct() {
  if (cholmod_) {
    if (!cholmod_->factorise(system_.matrix())) return false;
    cholmod_->solve(system_.residual(), dx_);
    iterations_ = 1;
  } else {
    iterations_ =
        pcg_->solve(system_.matrix(), system_.residual(), kPcgTolerance, 20 * system_.size(), dx_);
  }
  for (int i = 0; i < system_.size(); ++i) x_.col(system_.node(i)) -= dx_.col(i).head<3>();
  return true;
}

bool BaselineModel::step(double dt, const math::Pose& clamp, const Eigen::Matrix3Xd& loads) {
  const double begin = thread_time();
  predict(dt, clamp);
  system_.assemble(x_, x_inertial_, loads, inertia_);
  assembly_time_ = thread_time() - begin;
  const bool good = correct();
  if (dynamic_) v_ = (x_ - x_begin_) / dt;
  return good;
}

bool BaselineModel::converge(double dt, const math::Pose& clamp, const Eigen::Matrix3Xd& loads,
                             double tolerance) {
  constexpr int kMostSteps = 30;
  predict(dt, clamp);
  bool good = false;
  for (int k = 0; k < kMostSteps && !good; ++k) {
    system_.assemble(x_, x_inertial_, loads, inertia_);
    good = system_.residual().colwise().norm().maxCoeff() <= tolerance;
    if (!good && !correct()) break;
  }
  if (dynamic_) v_ = (x_ - x_begin_) / dt;
  return good;
}

}  // namespace palpate::bench
