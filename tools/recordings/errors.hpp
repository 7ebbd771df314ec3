#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/recordings/plan.hpp"

namespace palpate::recordings {

/// Prediction errors over rows that belong together.
struct Errors {
  Eigen::Index rows = 0;
  Eigen::VectorXd rms;            // per output
  Eigen::VectorXd mean_absolute;  // per output
  Eigen::VectorXd correlation;    // per output; 0 if one of the two is constant
  std::vector<double> norms;      // per group: RMS of the norm of the error
  std::vector<double> lengths;    // per group: RMS of the error of the norm, independent of frames
  /// Per group, directions only (otherwise 0): median and 90th percentile of the angle, rad.
  std::vector<double> median_angle;
  std::vector<double> angle_90;
};

/// Throws std::invalid_argument if sizes differ or there is no row.
Errors measure_errors(const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& truth,
                      const std::vector<ColumnGroup>& outputs);

}  // namespace palpate::recordings
