#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace palpate::sensor_models {

/// A force over time, in O: of the hand on the object.
struct ForceSeries {
  std::vector<double> time;  // s
  Eigen::Matrix3Xd force;    // N
  Eigen::Matrix3Xd torque;   // N m, about G; empty where it is not known
};

/// What the daemon says of the first wrist in the CONTACTS of its log, after `begin` (s). Throws
/// std::runtime_error where it says nothing.
ForceSeries read_wrist_contacts(const std::filesystem::path& log, double begin);

/// The simulator's truth: the force of all fingertips, from TRUTH_TOUCH.
ForceSeries read_true_touch(const std::filesystem::path& housekeeping_log);

/// A contact wrench where there is none.
struct ResidualScore {
  double force_rms = 0, force_max = 0;    // N, of the norm
  double torque_rms = 0, torque_max = 0;  // N m, of the norm
};
ResidualScore score_residual(const ForceSeries& felt);

/// A contact force beside the true one, while that acts.
struct TrackingScore {
  double peak = 0;        // N, largest true force
  double error_rms = 0;   // N, of the norm of the error
  double error_max = 0;   // N
  double peak_error = 0;  // N, by which the largest felt force differs from the largest true one
  double lag = 0;         // s, by which what is felt lags behind, for the least RMS error
  double lagged_rms = 0;  // N, were that lag not
  double lagged_max = 0;  // N
};

/// Both at the times of `truth` from its first force above zero to its last. Throws
/// std::runtime_error where nothing touches.
TrackingScore score_tracking(const ForceSeries& felt, const ForceSeries& truth);

/// Size of the difference at every time of `truth`, N.
Eigen::RowVectorXd tracking_error(const ForceSeries& felt, const ForceSeries& truth);

}  // namespace palpate::sensor_models
