#include "tools/fit/experiments/swing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::fit {
namespace {

struct Peak {
  double time = 0;
  double size = 0;
};

/// Maximum of the parabola through sample i and its neighbours, uniformly spaced.
Peak top(const Eigen::VectorXd& times, const Eigen::VectorXd& deviation, Eigen::Index i) {
  const double a = deviation[i - 1], b = deviation[i], c = deviation[i + 1];
  const double bend = a - 2 * b + c;
  const double s = bend != 0 ? std::clamp(0.5 * (a - c) / bend, -1.0, 1.0) : 0;
  return {times[i] + s * (times[i + 1] - times[i]), std::abs(b - 0.25 * (a - c) * s)};
}

}  // namespace

Swing measure_swing(const Eigen::VectorXd& times, const Eigen::VectorXd& values, double rest,
                    double least) {
  const Eigen::VectorXd deviation = values.array() - rest;
  std::vector<double> passages;
  std::vector<Peak> peaks;  // between zero crossings
  Eigen::Index greatest = -1;
  for (Eigen::Index i = 1; i < times.size(); ++i) {
    if (deviation[i - 1] * deviation[i] <= 0 && deviation[i - 1] != deviation[i]) {
      if (greatest > 0 && !passages.empty()) {
        const Peak peak = top(times, deviation, greatest);
        if (peak.size < least) break;
        peaks.push_back(peak);
      }
      const double share = deviation[i - 1] / (deviation[i - 1] - deviation[i]);
      passages.push_back(times[i - 1] + share * (times[i] - times[i - 1]));
      greatest = -1;
    }
    if (i + 1 < times.size() &&
        (greatest < 0 || std::abs(deviation[i]) > std::abs(deviation[greatest]))) {
      greatest = i;
    }
  }
  Swing swing;
  const std::size_t count = peaks.size();
  if (count < 3) return swing;
  swing.half_periods = static_cast<int>(count);
  swing.period = 2 * (passages[count] - passages[0]) / static_cast<double>(count);
  double time = 0, level = 0, squares = 0, product = 0;
  for (const Peak& p : peaks) {
    time += p.time / static_cast<double>(count);
    level += std::log(p.size) / static_cast<double>(count);
  }
  for (const Peak& p : peaks) {
    squares += (p.time - time) * (p.time - time);
    product += (p.time - time) * (std::log(p.size) - level);
  }
  swing.decay = -product / squares;
  return swing;
}

}  // namespace palpate::fit
