#pragma once

#include <utility>

#include "core/control/control_law.hpp"

namespace palpate::baselines {

struct ProbeOptions {
  double distance = 0.01;  // m, probing motion along an axis
  double angle = 0.08;     // rad, probing motion about an axis
  double move = 0.3;       // s, duration of a motion
  double settle = 0.2;     // s, subsequent waiting time for the object to settle
};

/// Six small, smooth motions of the hand in sequence, along x, y, z of O and about them, each
/// starting where the previous one ended.
class Probes {
 public:
  /// Throws std::invalid_argument if an option is not positive.
  explicit Probes(const ProbeOptions& options);

  /// Twist of this tick. Requires !done().
  math::Twist step(double dt) noexcept;
  /// True once after each settled probing motion; count() is the number of settled motions.
  bool take_settled() noexcept { return std::exchange(settled_, false); }
  int count() const noexcept { return count_; }
  bool done() const noexcept { return count_ == 6; }
  double duration() const noexcept { return 6 * (options_.move + options_.settle); }  // s
  void restart() noexcept {
    count_ = 0;
    time_ = 0;
    settled_ = false;
  }

 private:
  ProbeOptions options_;
  int count_ = 0;
  double time_ = 0;  // s, since the start of the present motion
  bool settled_ = false;
};

}  // namespace palpate::baselines
