#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>

#include "core/math/random.hpp"
#include "sim/sensors/sensor_table.hpp"

namespace palpate::sensors {

/// Samples values of type T at a fixed rate and delivers them late, in order, with losses.
template <class T>
class Channel {
 public:
  Channel(const Timing& timing, math::Random random) : timing_(timing), random_(random) {}

  /// True once for each sample that is due at the simulated time `now_us`. If the rate does not
  /// divide that of the tick, samples fall on the first tick at or after their time.
  bool due(std::int64_t now_us) {
    if (now_us < next_us_) return false;
    ++count_;
    next_us_ = static_cast<std::int64_t>(std::ceil(count_ * 1e6 / timing_.rate - 1e-6));
    return true;
  }

  void put(std::int64_t now_us, T sample) {
    const double late = timing_.delay + timing_.jitter * std::abs(random_.normal());
    const bool lost = random_.uniform() < timing_.drop_out;
    if (lost) return;
    const auto arrival = now_us + static_cast<std::int64_t>(std::lround(1e6 * late));
    last_arrival_us_ = std::max(last_arrival_us_, arrival);
    queue_.emplace_back(last_arrival_us_, std::move(sample));
  }

  /// The oldest sample that has arrived by `now_us`; false if there is none.
  bool take(std::int64_t now_us, T& sample) {
    if (queue_.empty() || queue_.front().first > now_us) return false;
    sample = std::move(queue_.front().second);
    queue_.pop_front();
    return true;
  }

  double period() const { return 1 / timing_.rate; }  // s

  /// The time (us) that the message of a sample taken at `now_us` states.
  std::int64_t stamp(std::int64_t now_us) const {
    return now_us + std::lround(1e6 * timing_.stamp_delay);
  }

 private:
  Timing timing_;
  math::Random random_;
  std::int64_t count_ = 0;
  std::int64_t next_us_ = 0;
  std::int64_t last_arrival_us_ = 0;
  std::deque<std::pair<std::int64_t, T>> queue_;
};

/// Applies a sensor's errors to a signal: value with hysteresis (play operator of Prandtl) + bias +
/// drift + noise, then quantised.
class Signal {
 public:
  /// `period`: s between samples. The size of `bias` sets the number of axes.
  Signal(const Faults& faults, double period, const Eigen::VectorXd& bias, math::Random random)
      : faults_(faults), walk_(faults.drift * std::sqrt(period)), offset_(bias), random_(random) {}

  Eigen::VectorXd measure(const Eigen::VectorXd& value) {
    if (played_.size() == 0) played_ = value;
    const double play = faults_.hysteresis;
    played_ =
        played_.cwiseMax((value.array() - play).matrix()).cwiseMin((value.array() + play).matrix());
    Eigen::VectorXd measured = played_;
    for (Eigen::Index i = 0; i < value.size(); ++i) {
      offset_(i) += walk_ * random_.normal();
      measured(i) += offset_(i) + faults_.noise * random_.normal();
      if (faults_.step > 0) measured(i) = faults_.step * std::round(measured(i) / faults_.step);
    }
    return measured;
  }

 private:
  Faults faults_;
  double walk_;
  Eigen::VectorXd offset_;
  Eigen::VectorXd played_;
  math::Random random_;
};

}  // namespace palpate::sensors
