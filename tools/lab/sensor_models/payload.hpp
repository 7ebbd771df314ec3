#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "core/sensing/payload.hpp"

namespace palpate::sensor_models {

/// Fit of a rigid payload to one recording.
struct PayloadScore {
  std::string recording;
  sensing::PayloadFit fit;
  bool reversed = false;       // the sensor reports what the load exerts on it
  double gravity_tilt = 0;     // rad, angle of the fitted gravity to the base's -z
  double left_out_force = -1;  // N, RMS of |F| at poses left out one by one; negative: not computed
  double left_out_torque = -1;  // N m
  double force_bar = 0;         // N, upper bound of `measured`
  double measured = 0;          // N: |F| RMS, or that of the worst axis if the bound is per axis
  bool bar_per_axis = false;
  bool has_bar() const { return force_bar > 0; }
  bool met() const { return !has_bar() || measured <= force_bar; }
};

/// Payload identification from the recordings below `data`. Throws if a file cannot be read or is
/// missing. ATI: the sensor's bias drifts by two newtons over its sixty poses; the variant holds it
/// constant.
PayloadScore score_static_ati(const std::filesystem::path& data);
PayloadScore score_static_ati_constant_bias(const std::filesystem::path& data);
/// Meca500: gravity is far from the base's -z (an arm on a wall), so its direction is fitted too.
PayloadScore score_static_meca500(const std::filesystem::path& data);
PayloadScore score_static_ntnu(const std::filesystem::path& data);
/// Ten parameters and bias from motion; all streams as means over 0.1 s, specific force from the
/// IMU.
PayloadScore score_motion_ntnu(const std::filesystem::path& data);
/// The same motion explained by gravity alone, for comparison.
PayloadScore score_motion_ntnu_gravity(const std::filesystem::path& data);

struct PayloadOptions {
  std::filesystem::path data;  // folder of the recordings
  std::filesystem::path json;  // empty: none
};

/// Identifies the payload of every available recording, prints a table and returns the exit code:
/// 0, or 1 if a bound is missed. Missing recordings are reported and skipped.
int run_payload(const PayloadOptions& options, std::ostream& out);

}  // namespace palpate::sensor_models
