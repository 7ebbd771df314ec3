#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "core/sensing/payload.hpp"

namespace palpate::sensor_models {

/// How well a rigid payload explains one recording.
struct PayloadScore {
  std::string recording;
  sensing::PayloadFit fit;
  bool reversed = false;        // the sensor reports what the load exerts on it
  double gravity_tilt = 0;      // rad, of gravity as fitted off the base's -z
  double left_out_force = -1;   // N, RMS of |F| at poses left out one by one; below 0: not made
  double left_out_torque = -1;  // N m
  double force_bar = 0;         // N, to be met by `measured`
  double measured = 0;          // N: |F| RMS, or that of the worst axis where the bar is per axis
  bool bar_per_axis = false;
  bool has_bar() const { return force_bar > 0; }
  bool met() const { return !has_bar() || measured <= force_bar; }
};

/// Payload identification from the recordings below `data`. Throws where a file is there and cannot
/// be read or is absent.
/// ATI: the sensor's bias drifts by two newtons over its sixty poses; the variant holds it
/// constant.
PayloadScore score_static_ati(const std::filesystem::path& data);
PayloadScore score_static_ati_constant_bias(const std::filesystem::path& data);
/// Meca500: gravity stands far off the base's -z (an arm on a wall), so its direction is fitted
/// too.
PayloadScore score_static_meca500(const std::filesystem::path& data);
PayloadScore score_static_ntnu(const std::filesystem::path& data);
/// Ten parameters and bias from motion; all streams as means over 0.1 s, specific force from the
/// inertial unit.
PayloadScore score_motion_ntnu(const std::filesystem::path& data);
/// The same motion explained by gravity alone, for comparison.
PayloadScore score_motion_ntnu_gravity(const std::filesystem::path& data);

struct PayloadOptions {
  std::filesystem::path data;  // folder of the recordings
  std::filesystem::path json;  // empty: none
};

/// Identifies the payload of every recording that is there, prints a table and returns the exit
/// code: 0, or 1 where a bar is missed. Recordings that are absent are said to be and passed over.
int run_payload(const PayloadOptions& options, std::ostream& out);

}  // namespace palpate::sensor_models
