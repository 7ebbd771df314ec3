#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rt/registry/frames.hpp"

namespace palpate::sensor_models {

/// LCM logs of one simulated motion, stamped with simulated time of arrival.
struct MotionLogs {
  std::filesystem::path control;       // sensors and robot
  std::filesystem::path housekeeping;  // the ground truth
};

/// Runs a scene to the end of its own motion, as fast as the machine allows and bit-identical to
/// palpate-sim, and writes its messages to `folder`/`name`.control.log and .housekeeping.log.
/// `longest`: s, maximum length; 0: unlimited. Throws config::Error, and std::runtime_error if a
/// log cannot be written or the scene has no motion.
MotionLogs record_motion(const std::filesystem::path& scene,
                         const std::vector<std::string>& overrides,
                         const std::filesystem::path& folder, const std::string& name,
                         double longest = 0);

/// Writes the robot's, inertial and wrist streams of a log as a CSV for palpate-train's wrist data:
/// t_s; pose and velocity of S in W: qw, qx, qy, qz, vx, vy, vz; angular velocity and specific
/// force at the origin of S, in S: gyr_{x,y,z}, acc_{x,y,z}; reading: fx, fy, fz, tx, ty, tz. One
/// row per millisecond, of what had arrived, as a 1 kHz loop receives it. `rate`: Hz, of the
/// model's steps, over which the angular velocity is differentiated as ft_rnnob does it. Throws
/// std::runtime_error if a stream is missing or the file cannot be written.
void write_wrist_csv(const std::filesystem::path& control_log, const registry::Frames& frames,
                     double rate, const std::filesystem::path& csv);

}  // namespace palpate::sensor_models
