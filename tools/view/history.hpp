#pragma once

#include <cstdint>
#include <deque>
#include <nlohmann/json.hpp>

#include "tools/view/scene.hpp"

namespace palpate::view {

/// The last two minutes of the plotted values, which a newly connected page receives first.
class History {
 public:
  static constexpr std::int64_t kKept = 120'000'000;  // us

  /// Takes a sample if the last one is at least 0.1 s old.
  void sample(const Scene& scene, std::int64_t now_us);
  /// Lists "time" (s before `now_us`, negative), "error", "cycle", "wake_up" (us), "view" (ms),
  /// "test", "threshold", "contradiction" (the test while it is inconsistent).
  nlohmann::json to_json(std::int64_t now_us) const;

 private:
  struct Sample {
    std::int64_t time_us;
    double error, cycle, wake_up, view, test, threshold, contradiction;  // NaN: not known
  };
  std::deque<Sample> samples_;
};

}  // namespace palpate::view
