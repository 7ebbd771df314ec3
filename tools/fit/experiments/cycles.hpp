#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::fit {

/// A range of samples in which the strain rises or falls, ends included.
struct HalfCycle {
  Eigen::Index first = 0;
  Eigen::Index last = 0;
  bool is_loading = true;
};

/// Half cycles between turning points; the strain must reverse by more than 30 % of its whole
/// range. Shorter parts at the ends are omitted.
std::vector<HalfCycle> half_cycles(const Eigen::VectorXd& strain);

/// First sample after the first `skip` cycles (a cycle: loading and unloading); the number of
/// samples if there are fewer.
Eigen::Index after_cycles(const Eigen::VectorXd& strain, int skip);

/// The mid-curve of the hysteresis: at `points` strains from 0 to the smallest maximum of the half
/// cycles, the mean over loading and unloading of all cycles after the first `skip`, without those
/// whose value is not finite.
struct MeanCurve {
  Eigen::VectorXd strain;
  Eigen::VectorXd value;
  int cycles = 0;  // averaged; 0: none were complete
};
MeanCurve mean_curve(const Eigen::VectorXd& strain, const Eigen::VectorXd& value, int skip,
                     int points);

}  // namespace palpate::fit
