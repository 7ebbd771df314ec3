#include "tools/fit/experiments/video.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tools/fit/recording.hpp"

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

/// With regular cycles several pairings fit: spreads that differ by less than this fraction of a
/// period count as equal, and the pairing of most peaks wins.
constexpr double kSameSpread = 0.1;

/// Times of the largest strains.
std::vector<double> peaks(const VectorXd& time, const VectorXd& strain) {
  std::vector<double> times;
  for (const HalfCycle& half : half_cycles(strain))
    if (half.is_loading) times.push_back(time[half.last]);
  return times;
}

/// NaN beyond the ends.
double interpolated(const VectorXd& x, const VectorXd& y, double at) {
  if (at < x[0] || at > x[x.size() - 1]) return std::numeric_limits<double>::quiet_NaN();
  const double* const begin = x.data();
  const Index right =
      std::clamp<Index>(std::upper_bound(begin, begin + x.size(), at) - begin, 1, x.size() - 1);
  const double part = std::clamp((at - x[right - 1]) / (x[right] - x[right - 1]), 0.0, 1.0);
  return y[right - 1] + part * (y[right] - y[right - 1]);
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

bool find_shift(const VectorXd& time, const VectorXd& strain, const VectorXd& other_time,
                const VectorXd& other, double& shift, double& spread) {
  const std::vector<double> ours = peaks(time, strain), theirs = peaks(other_time, other);
  constexpr int kLeastPairs = 2, kMostSkipped = 2;
  struct Pairing {
    std::size_t pairs;
    double shift, spread;
  };
  std::vector<Pairing> pairings;
  double least = std::numeric_limits<double>::infinity();
  for (int skip = -kMostSkipped; skip <= kMostSkipped; ++skip) {
    std::vector<double> differences;
    for (std::size_t k = 0; k < ours.size(); ++k) {
      const int j = static_cast<int>(k) + skip;
      if (j >= 0 && j < static_cast<int>(theirs.size())) differences.push_back(ours[k] - theirs[j]);
    }
    if (static_cast<int>(differences.size()) < kLeastPairs) continue;
    std::sort(differences.begin(), differences.end());
    const double middle = differences[differences.size() / 2];
    const double wide = std::max(differences.back() - middle, middle - differences.front());
    pairings.push_back({differences.size(), middle, wide});
    least = std::min(least, wide);
  }
  if (pairings.empty()) return false;
  const double period = (ours.back() - ours.front()) / static_cast<double>(ours.size() - 1);
  const Pairing* best = nullptr;
  for (const Pairing& pairing : pairings)
    if (pairing.spread <= least + kSameSpread * period && (!best || pairing.pairs > best->pairs))
      best = &pairing;
  shift = best->shift;
  spread = best->spread;
  return true;
}

VectorXd aligned_widths(const config::Node& node, const std::filesystem::path& folder,
                        const UniaxialData& data) {
  const Recording video(node, folder,
                        {{"time", Dimension::kTime, "by the video's clock"},
                         {"width", Dimension::kLength, "across"},
                         {"height", Dimension::kLength, "in the direction of the test"}});
  video.require_rows(4);
  video.require_rising("time");
  video.require_varying("width");
  video.require_varying("height");
  if (data.time.size() == 0) node.fail("", "needs a column `time` of the test");
  const VectorXd& height = video.column("height");
  const VectorXd strain = (height.array() / height[0] - 1) * (data.is_compression ? -1 : 1);
  double shift = 0, spread = 0;
  if (!find_shift(data.time, data.strain, video.column("time"), strain, shift, spread))
    video.fail("has fewer than two peaks of strain to put its clock by");
  VectorXd widths(data.time.size());
  for (Index i = 0; i < widths.size(); ++i)
    widths[i] = interpolated(video.column("time"), video.column("width"), data.time[i] - shift);
  return widths;
}

}  // namespace palpate::fit
