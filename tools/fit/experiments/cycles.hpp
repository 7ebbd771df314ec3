#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::fit {

/// A stretch of samples in which the strain rises or falls, ends included.
struct HalfCycle {
  Eigen::Index first = 0;
  Eigen::Index last = 0;
  bool is_loading = true;
};

/// From turn to turn; a turn is where the strain comes back by more than 30 % of its whole range.
/// What is shorter than that at the ends is left out.
std::vector<HalfCycle> half_cycles(const Eigen::VectorXd& strain);

/// First sample of what follows the first `skip` cycles (a cycle: loading and unloading); the count
/// of samples where there are fewer.
Eigen::Index after_cycles(const Eigen::VectorXd& strain, int skip);

/// The curve in the middle of the hysteresis: at `points` strains from 0 to the least of what the
/// half cycles reach, the mean over loading and unloading of all cycles after the first `skip`, of
/// which those where the value is not finite are left out.
struct MeanCurve {
  Eigen::VectorXd strain;
  Eigen::VectorXd value;
  int cycles = 0;  // averaged; 0: none were whole
};
MeanCurve mean_curve(const Eigen::VectorXd& strain, const Eigen::VectorXd& value, int skip,
                     int points);

}  // namespace palpate::fit
