#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "rt/config/node.hpp"
#include "tools/fit/experiments/uniaxial_data.hpp"

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

/// Widths of a bar from a camera with a separate clock, at the times of the test. In YAML: a
/// recording with the columns `time`, `width` and `height` (along the axis).
///
/// The camera's clock is shifted so that the turning points of its strain, from the height,
/// coincide with those of the machine's strain: by the median difference of the peaks, paired in
/// order from the first of one and the first, second, ... of the other, choosing the pairing of
/// most peaks with the smallest spread. NaN where the camera has no measurement. Throws
/// import::CsvError if fewer than two peaks can be paired.
Eigen::VectorXd aligned_widths(const config::Node& node, const std::filesystem::path& folder,
                               const UniaxialData& data);

/// Offset to add to the times of `other`; `spread` is the largest deviation of a peak from it.
/// False if fewer than two peaks can be paired.
bool find_shift(const Eigen::VectorXd& time, const Eigen::VectorXd& strain,
                const Eigen::VectorXd& other_time, const Eigen::VectorXd& other, double& shift,
                double& spread);

}  // namespace palpate::fit
