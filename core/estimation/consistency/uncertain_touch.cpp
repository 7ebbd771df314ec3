#include "core/estimation/consistency/uncertain_touch.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"

namespace palpate::estimation {
namespace {

/// Size of the force of a contact that the model does not have, relative to that of the hand, which
/// bears a part of it; and variance of the part of the wrench that its assumed place does not
/// explain, because it acts elsewhere and over an area.
constexpr double kSize = 4, kElsewhere = 0.25 * 0.25;

/// Covariance of the wrench by an uncertain unit force that acts elsewhere than `by_force` says.
math::Matrix6d elsewhere(const math::Vector6d& by_force) noexcept {
  math::Matrix6d covariance = math::Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(kElsewhere * by_force.head<3>().squaredNorm());
  covariance.diagonal().tail<3>().setConstant(kElsewhere * by_force.tail<3>().squaredNorm());
  return covariance;
}

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
    variance = std::max(0.0, square - rectified * rectified);
    rest = std::max(0.0, variance - linear * linear);
  }
  double open;    // probability that F is negative; one minus this is the regression on F
  double excess;  // of the mean
  double variance;
  double rest;  // of the variance, that the regression leaves
};

}  // namespace

void UncertainTouch::take(const elasticity::DeformationModel& model, double stiffness) noexcept {
  if (directions_.empty()) return;
  force_.fill(0);
  nearest_.fill(Nearest());
  for (const elasticity::SurfaceContact& contact : model.contacts()) {
    const auto obstacle = static_cast<std::size_t>(contact.obstacle);
    force_[obstacle] += stiffness * contact.normal_force();
    Nearest& nearest = nearest_[obstacle];
    if (contact.gap >= nearest.gap) continue;
    nearest.gap = contact.gap;
    nearest.position = contact.position;
    nearest.normal = contact.normal;
  }
  for (std::size_t o = 0; o < nearest_.size(); ++o)
    if (force_[o] == 0 && nearest_[o].gap < std::numeric_limits<double>::infinity())
      find_response(model, nearest_[o]);
  by_displacement_ = model.sensitivity().dcontact_dobstacle;
  for (auto& row : by_displacement_) row *= stiffness;
}

void UncertainTouch::find_response(const elasticity::DeformationModel& model,
                                   Nearest& nearest) noexcept {
  Eigen::Index node = 0;
  (model.positions().colwise() - nearest.position).colwise().squaredNorm().minCoeff(&node);
  for (std::size_t g = 0; g < model.body().grasps.size(); ++g) {
    if (!model.is_held(static_cast<int>(g))) continue;
    nearest.by_force[g] =
        -model.sensitivity().dx_dxi[g].middleRows<3>(3 * node).transpose().lazyProduct(
            nearest.normal);
  }
}

/// `variance`: m^2, of the distance.
math::Matrix6d UncertainTouch::possible_contact(int grasp, const Nearest& nearest, double variance,
                                                double force) noexcept {
  constexpr double kLeast = 0.01;  // probability below which the contact counts as open
  const double touches = 0.5 * std::erfc(nearest.gap / std::sqrt(2 * variance));
  if (!(touches > kLeast)) return math::Matrix6d::Zero();
  const math::Vector6d& by_force = nearest.by_force[static_cast<std::size_t>(grasp)];
  const double variance_of_force = touches * std::pow(kSize * force, 2);
  return variance_of_force * (by_force * by_force.transpose() + elsewhere(by_force));
}

UncertainTouch::Wrench UncertainTouch::linearise(
    int grasp, const elasticity::Sensitivity::ObstacleWrenches& by_direction,
    const Directions& known, double force) const noexcept {
  Wrench wrench{by_direction, math::Vector6d::Zero(), math::Matrix6d::Zero()};
  for (std::size_t first = 0, end = 0; first < directions_.size(); first = end) {
    const auto obstacle = static_cast<std::size_t>(directions_[first].obstacle);
    while (end < directions_.size() && directions_[end].obstacle == directions_[first].obstacle)
      ++end;
    const auto begin = static_cast<Eigen::Index>(first);
    const auto count = static_cast<Eigen::Index>(end - first);
    if (force_[obstacle] == 0) {
      double displacement = 0;  // m^2, variance; the distance hardly depends on rotations
      for (Eigen::Index k = begin; k < begin + count; ++k)
        if (directions_[static_cast<std::size_t>(k)].axis < 3) displacement += known(k, k);
      if (displacement > 0)
        wrench.covariance += possible_contact(grasp, nearest_[obstacle], displacement, force);
      continue;
    }
    if (by_displacement_[obstacle].cols() < begin + count) continue;
    const auto c = by_displacement_[obstacle].segment(begin, count);
    const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, collision::kMostFreeDirections, 1> spread =
        known.block(begin, begin, count, count).lazyProduct(c.transpose());
    const double variance = c.dot(spread);
    if (!(variance > 0)) continue;
    const Rectified normal(force_[obstacle], std::sqrt(variance));
    auto own = wrench.by_direction.middleCols(begin, count);
    const math::Vector6d by_force = own.lazyProduct(spread) / variance;
    own -= normal.open * by_force * c;
    wrench.excess += normal.excess * by_force;
    wrench.covariance += normal.rest * by_force * by_force.transpose();
    wrench.covariance += normal.variance * elsewhere(by_force);
  }
  return wrench;
}

}  // namespace palpate::estimation
