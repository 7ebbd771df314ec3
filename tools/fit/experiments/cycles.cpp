#include "tools/fit/experiments/cycles.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The value where the half cycle first crosses the strain, interpolated between samples; constant
/// beyond its end.
double value_at(const VectorXd& strain, const VectorXd& value, const HalfCycle& half, double at) {
  const double sign = half.is_loading ? 1 : -1;
  for (Index i = half.first + 1; i <= half.last; ++i) {
    if (sign * (strain[i] - at) < 0) continue;
    const double gap = strain[i] - strain[i - 1];
    const double part = gap != 0 ? std::clamp((at - strain[i - 1]) / gap, 0.0, 1.0) : 1.0;
    return value[i - 1] + part * (value[i] - value[i - 1]);
  }
  return value[half.last];
}

}  // namespace

std::vector<HalfCycle> half_cycles(const VectorXd& strain) {
  std::vector<HalfCycle> halves;
  if (strain.size() < 2) return halves;
  const double threshold = 0.3 * (strain.maxCoeff() - strain.minCoeff());
  // The farthest sample in the current direction becomes a turning point once the strain reverses
  // far enough.
  Index turn = 0, low = 0, high = 0;
  int direction = 0;
  for (Index i = 1; i < strain.size(); ++i) {
    if (direction <= 0 && strain[i] < strain[low]) low = i;
    if (direction >= 0 && strain[i] > strain[high]) high = i;
    if (direction <= 0 && strain[i] - strain[low] > threshold) {
      if (direction < 0) halves.push_back({turn, low, false});
      turn = low, high = i, direction = 1;
    } else if (direction >= 0 && strain[high] - strain[i] > threshold) {
      if (direction > 0) halves.push_back({turn, high, true});
      turn = high, low = i, direction = -1;
    }
  }
  if (direction != 0) halves.push_back({turn, direction > 0 ? high : low, direction > 0});
  return halves;
}

Index after_cycles(const VectorXd& strain, int skip) {
  int seen = 0;
  for (const HalfCycle& half : half_cycles(strain)) {
    if (half.is_loading && seen >= skip) return half.first;
    if (half.is_loading) ++seen;
  }
  return skip == 0 ? 0 : strain.size();
}

MeanCurve mean_curve(const VectorXd& strain, const VectorXd& value, int skip, int points) {
  MeanCurve curve;
  const std::vector<HalfCycle> halves = half_cycles(strain);
  std::vector<HalfCycle> used;
  int loadings = 0;
  for (std::size_t k = 0; k + 1 < halves.size(); ++k) {
    if (!halves[k].is_loading || halves[k + 1].is_loading || loadings++ < skip) continue;
    used.push_back(halves[k]);
    used.push_back(halves[k + 1]);
  }
  curve.cycles = static_cast<int>(used.size()) / 2;
  if (used.empty()) return curve;
  double reach = strain.maxCoeff();
  for (const HalfCycle& half : used)
    reach = std::min(reach, strain[half.is_loading ? half.last : half.first]);
  curve.strain.setLinSpaced(points, 0, reach);
  curve.value.setZero(points);
  for (Index i = 0; i < points; ++i) {
    int count = 0;
    for (std::size_t k = 0; k < used.size(); k += 2) {
      const double both = value_at(strain, value, used[k], curve.strain[i]) +
                          value_at(strain, value, used[k + 1], curve.strain[i]);
      if (!std::isfinite(both)) continue;
      curve.value[i] += both;
      count += 2;
    }
    curve.value[i] /= count;
  }
  return curve;
}

}  // namespace palpate::fit
