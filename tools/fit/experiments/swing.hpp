#pragma once

#include <Eigen/Core>

namespace palpate::fit {

/// A free oscillation that dies away.
struct Swing {
  double period = 0;     // s
  double decay = 0;      // 1/s: amplitudes fall by exp(-decay t)
  int half_periods = 0;  // that both were taken from
};

/// Of values about `rest` at rising times: the period from the mean distance of passages through
/// rest, the decay by a straight line through the logarithms of the greatest deviations between
/// them, as far as they exceed `least`. Fewer than three half periods: zeros.
Swing measure_swing(const Eigen::VectorXd& times, const Eigen::VectorXd& values, double rest,
                    double least);

}  // namespace palpate::fit
