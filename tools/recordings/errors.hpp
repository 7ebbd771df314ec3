#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/recordings/plan.hpp"

namespace palpate::recordings {

/// How far predictions are from the truth, over rows that belong together.
struct Errors {
  Eigen::Index rows = 0;
  Eigen::VectorXd rms;            // per output
  Eigen::VectorXd mean_absolute;  // per output
  Eigen::VectorXd correlation;    // per output; 0 where one of the two does not move
  std::vector<double> norms;      // per group: RMS of the length of the error
  std::vector<double> lengths;    // per group: RMS of the error of the length, free of frames
  /// Per group, directions only (else 0): median and 90th percentile of the angle, rad.
  std::vector<double> median_angle;
  std::vector<double> angle_90;
};

/// Throws std::invalid_argument where sizes differ or there is no row.
Errors measure_errors(const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& truth,
                      const std::vector<ColumnGroup>& outputs);

}  // namespace palpate::recordings
