#include "tools/recordings/delay.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::recordings {

DelayFit identify_delay(const Eigen::MatrixXd& reference, const Eigen::MatrixXd& signal,
                        double rate, double largest) {
  const Eigen::Index n = reference.rows();
  const auto span = static_cast<Eigen::Index>(std::llround(largest * rate));
  if (signal.rows() != n || signal.cols() != reference.cols())
    throw std::invalid_argument("delay: the recordings differ in size");
  if (n < 4 * span + 4)
    throw std::invalid_argument("delay: the recordings are too short for the largest delay");

  // The same rows of the reference at each delay, so that the correlations are comparable.
  const Eigen::MatrixXd still = reference.middleRows(span, n - 2 * span);
  const Eigen::MatrixXd still_centred = still.rowwise() - still.colwise().mean();
  const auto correlation = [&](Eigen::Index delay) {
    const Eigen::MatrixXd moved = signal.middleRows(span + delay, n - 2 * span);
    const Eigen::MatrixXd centred = moved.rowwise() - moved.colwise().mean();
    const double size = still_centred.norm() * centred.norm();
    return size > 0 ? still_centred.cwiseProduct(centred).sum() / size : 0;
  };
  Eigen::Index best = 0;
  double best_value = correlation(0);
  for (Eigen::Index delay = -span; delay <= span; ++delay) {
    const double value = correlation(delay);
    if (value > best_value) {
      best = delay;
      best_value = value;
    }
  }
  DelayFit fit{static_cast<double>(best) / rate, best_value};
  if (best == -span || best == span) return fit;
  const double before = correlation(best - 1);
  const double after = correlation(best + 1);
  const double curvature = before - 2 * best_value + after;
  if (curvature < 0) fit.seconds += 0.5 * (before - after) / curvature / rate;
  return fit;
}

}  // namespace palpate::recordings
