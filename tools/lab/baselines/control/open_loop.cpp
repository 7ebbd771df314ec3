#include "tools/lab/baselines/control/open_loop.hpp"

#include <Eigen/LU>
#include <stdexcept>

#include "core/control/control_law.hpp"

namespace palpate::baselines {
namespace {

constexpr double kLength = 0.25;  // m, length that makes rotations comparable with displacements

}  // namespace

OpenLoop::OpenLoop(const Options& options, const InverseSolution& plan)
    : options_(options), plan_(plan) {
  if (!(options.gain > 0 && options.gain < 100) || !(options.linear_speed > 0) ||
      !(options.angular_speed > 0) || !(options.filter > 0))
    throw std::invalid_argument("gain, speeds or filter of the open loop are out of range");
  if (!plan.converged) throw std::invalid_argument("inverse finite elements found no equilibrium");
  if (!options.by_force) return;
  compliance_ = plan.stiffness.inverse();
  if (!compliance_.allFinite())
    throw std::invalid_argument("the object does not resist every motion of the hand");
}

void OpenLoop::observe(const control::Experience& now) noexcept {
  X_OG_ = now.X_OG;
  if (!now.wrench_valid) return;
  const math::Vector6d wrench = now.F_G_O.vector();
  if (!felt_any_) felt_ = wrench;
  felt_any_ = true;
  felt_ += now.dt / (options_.filter + now.dt) * (wrench - felt_);
}

bool OpenLoop::commands(const control::LawInputs&, math::Twist& V_O_G) noexcept {
  math::Vector6d way = math::Vector6d::Zero();
  if (!options_.by_force) {
    way.head<3>() = plan_.X_OG.translation() - X_OG_.translation();
    way.tail<3>() = math::log_rotation(plan_.X_OG.linear().lazyProduct(X_OG_.linear().transpose()));
  } else if (felt_any_) {
    way.noalias() = compliance_ * (plan_.F_G_O.vector() - felt_);
  }
  const double far = way.head<3>().norm() + kLength * way.tail<3>().norm();
  V_O_G = math::Twist();
  if (!(far > options_.dead_band)) return true;
  way *= options_.gain;
  V_O_G =
      control::limit_speed(math::Twist::from(way), options_.linear_speed, options_.angular_speed);
  return true;
}

}  // namespace palpate::baselines
