#include "core/contact/approach_record.hpp"

#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::contact {

ApproachRecord::ApproachRecord(double resolution) : resolution_(resolution) {
  math::check_positive_finite(resolution, "resolution");
}

void ApproachRecord::clear() noexcept { first_ = count_ = 0; }

void ApproachRecord::add(double travel, double force) noexcept {
  if (!std::isfinite(travel) || !std::isfinite(force)) return;
  if (count_ == 0 || travel >= end_) {
    if (count_ == kMostSteps)
      first_ = (first_ + 1) % kMostSteps;
    else
      ++count_;
    end_ = resolution_ * (std::floor(travel / resolution_) + 1);
    steps_[static_cast<std::size_t>((first_ + count_ - 1) % kMostSteps)] = {travel, force, 1};
    return;
  }
  Step& step = steps_[static_cast<std::size_t>((first_ + count_ - 1) % kMostSteps)];
  ++step.samples;
  step.travel += (travel - step.travel) / step.samples;
  step.force += (force - step.force) / step.samples;
}

}  // namespace palpate::contact
