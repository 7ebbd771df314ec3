#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace palpate::sensor_models {

/// A force over time, in O: of the hand on the object.
struct ForceSeries {
  std::vector<double> time;  // s
  Eigen::Matrix3Xd force;    // N
  Eigen::Matrix3Xd torque;   // N m, about G; empty if it is not known
};

/// The daemon's estimate for the first wrist in the CONTACTS of its log, after `begin` (s). Throws
/// std::runtime_error if there is none.
ForceSeries read_wrist_contacts(const std::filesystem::path& log, double begin);

/// The simulator's ground truth: the force of all fingertips, from TRUTH_TOUCH.
ForceSeries read_true_touch(const std::filesystem::path& housekeeping_log);

/// Residual wrench without contact.
struct ResidualScore {
  double force_rms = 0, force_max = 0;    // N, of the norm
  double torque_rms = 0, torque_max = 0;  // N m, of the norm
};
ResidualScore score_residual(const ForceSeries& felt);

/// A contact force compared with the true one, while that acts.
struct TrackingScore {
  double peak = 0;        // N, largest true force
  double error_rms = 0;   // N, of the norm of the error
  double error_max = 0;   // N
  double peak_error = 0;  // N, difference of the largest estimated and the largest true force
  double lag = 0;         // s, lag of the estimate that minimises the RMS error
  double lagged_rms = 0;  // N, with that lag removed
  double lagged_max = 0;  // N
};

/// Both at the times of `truth` from its first force above zero to its last. Throws
/// std::runtime_error if there is no contact.
TrackingScore score_tracking(const ForceSeries& felt, const ForceSeries& truth);

/// Norm of the difference at every time of `truth`, N.
Eigen::RowVectorXd tracking_error(const ForceSeries& felt, const ForceSeries& truth);

}  // namespace palpate::sensor_models
