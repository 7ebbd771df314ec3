#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "rt/daemon/settings.hpp"

namespace palpate::daemon {

/// Implements the overrun policy: lateness within a sliding window, and time without a command. One
/// late wake-up counts as one overrun, however late.
class OverrunMonitor {
 public:
  enum class Verdict { kFine, kDegraded, kSafeStop };

  explicit OverrunMonitor(const OverrunPolicy& policy) : policy_(policy) {}

  /// Call once per cycle with wake-up time and lateness (ns). Lateness below a tenth of a period is
  /// jitter and ignored.
  Verdict record(std::int64_t now_ns, std::int64_t lateness_ns, double period) noexcept {
    const bool first = last_ns_ == 0;
    const double gap = first ? 0 : static_cast<double>(now_ns - last_ns_) * 1e-9 - period;
    last_ns_ = now_ns;
    if (static_cast<double>(lateness_ns) * 1e-9 > 0.1 * period) {
      late_[next_] = {now_ns, lateness_ns};
      next_ = (next_ + 1) % late_.size();
    }
    if (gap >= policy_.safe_stop_after) return Verdict::kSafeStop;
    double sum = 0;
    for (const Late& late : late_) {
      if (static_cast<double>(now_ns - late.at_ns) * 1e-9 <= policy_.window) {
        sum += static_cast<double>(late.by_ns) * 1e-9;
      }
    }
    return sum >= policy_.degraded_after ? Verdict::kDegraded : Verdict::kFine;
  }

 private:
  struct Late {
    std::int64_t at_ns = -(std::int64_t{1} << 62);
    std::int64_t by_ns = 0;
  };
  OverrunPolicy policy_;
  std::array<Late, 64> late_{};
  std::size_t next_ = 0;
  std::int64_t last_ns_ = 0;
};

}  // namespace palpate::daemon
