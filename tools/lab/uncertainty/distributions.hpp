#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::uncertainty {

/// Error of a pose: standard deviations per axis.
struct PoseDeviation {
  double position = 0;   // m
  double angle_deg = 0;  // degrees
};

/// Distributions of the model errors that a set-up leaves: what palpated's configuration and its
/// sensors have wrong about the world. Each deviation is that of one axis of a normal distribution,
/// truncated at `truncated_at` deviations; 0: no such error. calibrated.yaml and uncalibrated.yaml
/// are normative.
struct Distributions {
  std::string name;  // of the file, without folder and extension
  std::string about;
  double truncated_at = 2;

  PoseDeviation hand;        // of the pose of the flange that ROBOT_STATE reports
  PoseDeviation camera;      // of the camera's pose
  double camera_noise = 0;   // factor on the published noise of a Kinect; 0: that of the scene
  double clamp = 0;          // m, place of the clamp in W
  double grasp = 0;          // m, place of the hand on the object, and of its rest pose
  double dimensions = 0;     // share of each edge of the object
  double young_modulus = 0;  // of log E
  double poisson_ratio = 0;
  double density = 0;                // share
  double uneven = 0;                 // share, of the stiffness from place to place
  double uneven_length = 0.1;        // m, over which it varies
  double gravity_deg = 0;            // degrees, direction, about each of two horizontal axes
  double payload_mass = 0;           // share of the hand's mass
  double payload_center = 0;         // m, of its centre of mass
  double force_bias = 0;             // N
  double torque_bias = 0;            // N m
  double force_drift = 0;            // N after 1 s, of a random walk; the same in every draw
  double torque_drift = 0;           // N m after 1 s
  double delay = 0;                  // s, of the force-torque sensor; half-normal: added
  double pads_factor = 1;            // of the pads' stiffness, log-uniform in [1 / factor, factor]
  std::vector<double> mesh_factors;  // of the cells of palpated's mesh, equally probable
  double creep = 0;                  // relative modulus of a Maxwell branch; half-normal
  std::vector<double> creep_time{};  // s, shortest and longest relaxation time, log-uniform
};

/// Reads and checks a file of distributions. Throws config::Error with file, line, key, value and
/// allowed range, also for an unknown key.
Distributions read_distributions(const std::filesystem::path& file);

}  // namespace palpate::uncertainty
