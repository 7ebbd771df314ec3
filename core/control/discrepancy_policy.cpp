#include "core/control/discrepancy_policy.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::control {
namespace {

double factor_of(const DiscrepancyPolicy::Options& options) {
  switch (options.action) {
    case DiscrepancyAction::kContinue:
      return 1;
    case DiscrepancyAction::kSlow:
      return options.speed;
    case DiscrepancyAction::kStop:
      break;
  }
  return 0;
}

}  // namespace

DiscrepancyPolicy::DiscrepancyPolicy(const Options& options)
    : options_(options), goal_(factor_of(options)) {
  math::check_option(options.speed >= 0 && options.speed <= 1, "discrepancy_speed", options.speed,
                     "0 to 1");
}

void DiscrepancyPolicy::update(bool in_doubt, double dt) noexcept {
  if (!(std::isfinite(dt) && dt > 0)) return;
  const double goal = in_doubt ? goal_ : 1, step = dt / kRampTime;
  factor_ = std::clamp(goal, factor_ - step, factor_ + step);
}

}  // namespace palpate::control
