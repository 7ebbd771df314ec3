#include "core/estimation/consistency/uncertain_touch.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"

namespace palpate::estimation {
namespace {

/// max(0, F) for a normally distributed F with this mean and standard deviation.
struct Rectified {
  Rectified(double mean, double deviation) noexcept {
    const double a = mean / deviation;
    open = 0.5 * std::erfc(a / std::sqrt(2.0));
    const double density = std::exp(-0.5 * a * a) / std::sqrt(2 * math::kPi);
    const double rectified = mean * (1 - open) + deviation * density;
    excess = rectified - mean;
    const double square =
        (mean * mean + deviation * deviation) * (1 - open) + mean * deviation * density;
    const double linear = (1 - open) * deviation;
    rest = std::max(0.0, square - rectified * rectified - linear * linear);
  }
  double open;    // probability that F is negative; one minus this is the regression on F
  double excess;  // of the mean
  double rest;    // variance that the regression leaves
};

}  // namespace

void UncertainTouch::take(const elasticity::DeformationModel& model, double stiffness) noexcept {
  if (directions_.empty()) return;
  force_.fill(0);
  for (const elasticity::SurfaceContact& contact : model.contacts())
    force_[static_cast<std::size_t>(contact.obstacle)] += stiffness * contact.normal_force();
  by_displacement_ = model.sensitivity().dcontact_dobstacle;
  for (auto& row : by_displacement_) row *= stiffness;
}

UncertainTouch::Wrench UncertainTouch::linearise(
    const elasticity::Sensitivity::ObstacleWrenches& by_direction,
    const Directions& known) const noexcept {
  Wrench wrench{by_direction, math::Vector6d::Zero(), math::Matrix6d::Zero()};
  for (std::size_t first = 0, end = 0; first < directions_.size(); first = end) {
    const auto obstacle = static_cast<std::size_t>(directions_[first].obstacle);
    while (end < directions_.size() && directions_[end].obstacle == directions_[first].obstacle)
      ++end;
    const auto begin = static_cast<Eigen::Index>(first);
    const auto count = static_cast<Eigen::Index>(end - first);
    if (by_displacement_[obstacle].cols() < begin + count) continue;
    const auto c = by_displacement_[obstacle].segment(begin, count);
    const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, collision::kMostFreeDirections, 1> spread =
        known.block(begin, begin, count, count).lazyProduct(c.transpose());
    const double variance = c.dot(spread);
    if (!(variance > 0)) continue;
    const Rectified force(force_[obstacle], std::sqrt(variance));
    auto own = wrench.by_direction.middleCols(begin, count);
    const math::Vector6d by_force = own.lazyProduct(spread) / variance;
    own -= force.open * by_force * c;
    wrench.excess += force.excess * by_force;
    wrench.covariance += force.rest * by_force * by_force.transpose();
  }
  return wrench;
}

}  // namespace palpate::estimation
