#include "tools/fit/experiments/video.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tools/fit/experiments/cycles.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

/// With regular cycles several pairings fit: spreads that differ by less than this fraction of a
/// period count as equal, and the pairing of most peaks wins.
constexpr double kSameSpread = 0.1;

using Eigen::Index;
using Eigen::VectorXd;

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
      if (j >= 0 && j < static_cast<int>(theirs.size()))
        differences.push_back(ours[k] - theirs[static_cast<std::size_t>(j)]);
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
