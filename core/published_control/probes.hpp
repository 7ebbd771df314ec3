#pragma once

#include <utility>

#include "core/control/control_law.hpp"

namespace palpate::published_control {

struct ProbeOptions {
  double distance = 0.01;  // m, of a probe along an axis
  double angle = 0.08;     // rad, of one about an axis
  double move = 0.3;       // s that the hand takes
  double settle = 0.2;     // s that it then waits for the object to come to rest
};

/// Six small motions of the hand one after the other, along x, y, z of O and about them, smoothly,
/// each from where the one before has ended.
class Probes {
 public:
  /// Throws std::invalid_argument where an option is not positive.
  explicit Probes(const ProbeOptions& options);

  /// The twist of this tick. Needs !done().
  math::Twist step(double dt) noexcept;
  /// True once after each probe that has settled; count() says how many have.
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
  double time_ = 0;  // s, of the present probe
  bool settled_ = false;
};

}  // namespace palpate::published_control
