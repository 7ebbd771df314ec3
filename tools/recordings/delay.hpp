#pragma once

#include <Eigen/Core>

namespace palpate::recordings {

struct DelayFit {
  double seconds = 0;      // lag of `signal` behind `reference`; negative: it leads
  double correlation = 0;  // of the two at that delay, 0 to 1
};

/// Delay at which the cross-correlation of two recordings of the same motion is largest. Both are n
/// x channels, sampled at `rate`; means are removed, channels are summed. Interpolated between
/// samples by a parabola through the three largest values. Throws std::invalid_argument if they
/// differ in size or are shorter than four times `largest` (s).
DelayFit identify_delay(const Eigen::MatrixXd& reference, const Eigen::MatrixXd& signal,
                        double rate, double largest);

}  // namespace palpate::recordings
