#include "tools/view/history.hpp"

#include <cmath>
#include <limits>

namespace palpate::view {

using nlohmann::json;

void History::sample(const Scene& scene, std::int64_t now_us) {
  constexpr std::int64_t kEvery = 100'000;  // us
  if (!samples_.empty() && now_us - samples_.back().time_us < kEvery) return;
  if (!scene.shape.get() && !scene.health.get()) return;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Sample s{now_us, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
  if (const feature_t* feature = scene.feature.get()) s.error = error_norm(*feature);
  if (const health_t* health = scene.health.get(); health && health->phase_count == kPhases) {
    s.cycle = static_cast<double>(health->p99_us[0]);
    s.wake_up = static_cast<double>(health->p99_us[kPhases - 1]);
  }
  if (const shape_t* shape = scene.shape.get())
    s.view = static_cast<double>(scene.shape.time_us - shape->utime) * 1e-3;
  if (const discrepancy_t* d = scene.discrepancy.get();
      d && d->test >= 0 && now_us - scene.discrepancy.time_us < kOld * 1000) {
    s.test = d->test;
    s.threshold = d->threshold;
    if (d->inconsistent != 0) s.contradiction = d->test;
  }
  samples_.push_back(s);
  while (now_us - samples_.front().time_us > kKept) samples_.pop_front();
}

json History::to_json(std::int64_t now_us) const {
  json out = {{"time", json::array()}};
  const std::pair<const char*, double Sample::*> kLists[] = {
      {"error", &Sample::error},
      {"cycle", &Sample::cycle},
      {"wake_up", &Sample::wake_up},
      {"view", &Sample::view},
      {"test", &Sample::test},
      {"threshold", &Sample::threshold},
      {"contradiction", &Sample::contradiction}};
  for (const auto& [key, value] : kLists) out[key] = json::array();
  for (const Sample& s : samples_) {
    out["time"].push_back(std::round(static_cast<double>(s.time_us - now_us) * 1e-4) * 1e-2);
    for (const auto& [key, value] : kLists) out[key].push_back(s.*value);
  }
  return out;
}

}  // namespace palpate::view
