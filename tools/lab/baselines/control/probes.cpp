#include "tools/lab/baselines/control/probes.hpp"

#include <cmath>
#include <stdexcept>

#include "core/math/constants.hpp"

namespace palpate::baselines {
namespace {

using math::kPi;

}  // namespace

Probes::Probes(const ProbeOptions& options) : options_(options) {
  const auto positive = [](double value) { return value > 0 && value < 1e3; };
  if (!positive(options.distance) || !positive(options.angle) || !positive(options.move) ||
      !(options.settle >= 0 && options.settle < 1e3))
    throw std::invalid_argument("a probe's distance, angle and times must be positive");
}

math::Twist Probes::step(double dt) noexcept {
  math::Vector6d twist = math::Vector6d::Zero();
  if (time_ < options_.move) {
    const double amplitude = count_ < 3 ? options_.distance : options_.angle;
    // the integral of 1 - cos over its period equals the period
    twist[count_] = amplitude / options_.move * (1 - std::cos(2 * kPi * time_ / options_.move));
  }
  time_ += dt;
  if (time_ >= options_.move + options_.settle) {
    time_ = 0;
    ++count_;
    settled_ = true;
  }
  return math::Twist::from(twist);
}

}  // namespace palpate::baselines
