#pragma once

#include <Eigen/Core>

namespace palpate::fit {

/// A damped free oscillation.
struct Swing {
  double period = 0;     // s
  double decay = 0;      // 1/s: amplitudes decay by exp(-decay t)
  int half_periods = 0;  // from which both were computed
};

/// Of values about `rest` at ascending times: the period from the mean interval between crossings
/// of the rest value, the decay by a straight line through the logarithms of the largest deviations
/// between them, as far as they exceed `least`. Zeros if there are fewer than three half periods.
Swing measure_swing(const Eigen::VectorXd& times, const Eigen::VectorXd& values, double rest,
                    double least);

}  // namespace palpate::fit
