#include "tools/collect/protocol.hpp"

#include <algorithm>
#include <cmath>

#include "core/sensing/biotac_geometry.hpp"

namespace palpate::collect {
namespace {

constexpr int kRepeats = 5;
constexpr double kLetGo = 0.2;  // s, of the release

std::vector<ForceProfile> profiles_of(Profiles profiles) {
  std::vector<ForceProfile> list{{"0.2N", 0.2}, {"0.3N", 0.3}, {"0.4N", 0.4}};
  if (profiles == Profiles::kExtended) {
    list.push_back({"0.8N", 0.8, 0.2, 0.3});
    list.push_back({"1.3N", 1.3, 0.4, 0.3});
    list.push_back({"2N", 1.6, 0.3, 0.25});
  }
  return list;
}

}  // namespace

const std::vector<Probe>& probes() {
  static const std::vector<Probe> list{
      {"flat_3", ProbeShape::kFlat, 3e-3},      {"flat_5", ProbeShape::kFlat, 5e-3},
      {"flat_7.5", ProbeShape::kFlat, 7.5e-3},  {"sphere_3", ProbeShape::kSphere, 3e-3},
      {"sphere_5", ProbeShape::kSphere, 5e-3},  {"sphere_7.5", ProbeShape::kSphere, 7.5e-3},
      {"concave", ProbeShape::kConcave, 10e-3},
  };
  return list;
}

std::vector<Trial> make_trials(Profiles profiles) {
  std::vector<Trial> trials;
  for (const Probe& probe : probes())
    for (int area = 1; area <= sensing::kAreaCount; ++area)
      for (const ForceProfile& profile : profiles_of(profiles))
        for (int repeat = 0; repeat < kRepeats; ++repeat)
          trials.push_back({static_cast<int>(trials.size()), probe, area, profile, repeat});
  return trials;
}

std::string name_of(const Trial& trial) {
  return trial.probe.name + " area " + std::to_string(trial.area) + " " + trial.profile.name + " " +
         std::to_string(trial.repeat + 1);
}

double envelope(double t) {
  const auto smooth = [](double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
  };
  return smooth((t - kRest) / kApproach) - smooth((t - kRest - kApproach - kHold) / kLetGo);
}

double contact_radius(const Probe& probe, double force, double foundation) {
  double curvature = 1 / sensing::kSkinRadius;  // of the gap
  if (probe.shape == ProbeShape::kSphere) curvature += 1 / probe.radius;
  if (probe.shape == ProbeShape::kConcave) curvature -= 1 / probe.radius;
  // force = foundation pi depth^2 / curvature, radius^2 = 2 depth / curvature
  const double depth = std::sqrt(force * curvature / (foundation * M_PI));
  const double radius = std::sqrt(2 * depth / curvature);
  return probe.shape == ProbeShape::kFlat ? std::min(radius, probe.radius) : radius;
}

}  // namespace palpate::collect
