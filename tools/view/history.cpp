#include "tools/view/history.hpp"

#include <cmath>
#include <limits>

namespace palpate::view {
namespace {

constexpr std::int64_t kEvery = 100'000;  // us
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double error_norm(const feature_t& feature) {
  if (feature.revision < 0) return kUnknown;
  double sum = 0;
  for (int i = 0; i < feature.error_count; ++i) sum += feature.error[i] * feature.error[i];
  return std::sqrt(sum);
}

void History::sample(const Scene& scene, std::int64_t now_us) {
  if (!samples_.empty() && now_us - samples_.back().time_us < kEvery) return;
  if (!scene.shape.get() && !scene.health.get()) return;
  Sample s{now_us, kUnknown, kUnknown, kUnknown, kUnknown};
  if (const feature_t* feature = scene.feature.get()) s.error = error_norm(*feature);
  if (const health_t* health = scene.health.get(); health && health->phase_count == 10) {
    s.cycle = static_cast<double>(health->p99_us[0]);
    s.wake_up = static_cast<double>(health->p99_us[9]);
  }
  if (const shape_t* shape = scene.shape.get())
    s.view = static_cast<double>(scene.shape.time_us - shape->utime) * 1e-3;
  samples_.push_back(s);
  while (now_us - samples_.front().time_us > kKept) samples_.pop_front();
}

nlohmann::json History::to_json(std::int64_t now_us) const {
  nlohmann::json out = {{"time", nlohmann::json::array()}};
  for (const char* key : {"error", "cycle", "wake_up", "view"}) out[key] = nlohmann::json::array();
  for (const Sample& s : samples_) {
    out["time"].push_back(std::round(static_cast<double>(s.time_us - now_us) * 1e-4) * 1e-2);
    out["error"].push_back(s.error);
    out["cycle"].push_back(s.cycle);
    out["wake_up"].push_back(s.wake_up);
    out["view"].push_back(s.view);
  }
  return out;
}

}  // namespace palpate::view
