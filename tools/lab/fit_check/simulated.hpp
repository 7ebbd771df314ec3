#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace palpate::fit_check {

/// A recording of palpate-sim, tick by tick.
struct SimulatedRecording {
  std::string scene;
  std::vector<std::string> overrides;
  std::vector<Eigen::Vector3d> markers;  // rest points of the plant, observed at 100 Hz
  /// Noise added to each message, in addition to the sensor's own: relative to the largest force
  /// and torque between hand and object, and to the markers' largest displacement.
  double noise = 0.01;
  int seed = 1;
};

/// Runs the scene's motion to its end and writes ROBOT_STATE, FT_WRENCH and, if there are markers,
/// SHAPE_OBSERVATION to an LCM log. `progress`: fraction done. Throws config::Error and
/// std::runtime_error.
void record(const SimulatedRecording& recording, const std::string& log,
            const std::function<void(double)>& progress = {});

/// The plant's material parameters found by a fit to simulated recordings.
struct Statement {
  std::string parameter;
  double truth = 0, found = 0, low = 0, high = 0;
  double error = 0;  // error of found: relative; of Poisson's ratio absolute
  double bar = 0;    // upper bound of the error
  bool is_met() const { return error <= bar; }
};

struct StatementOptions {
  std::string folder;                  // for logs
  std::vector<std::string> overrides;  // of the scenes
  std::string cells = "[20, 2, 2]";    // of the fitted mesh, quadratic
  std::function<void(const std::string& what, double share)> progress;
};

/// Young's modulus and Poisson's ratio from bar_rests.yaml, its width observed by markers; damping
/// from bar_stops.yaml. The plant is Neo-Hookean, on hexahedra; the fitted model is palpated's,
/// started 30 % off. Throws as record() does, and std::runtime_error if a fit fails.
std::vector<Statement> fit_simulated(const StatementOptions& options);

}  // namespace palpate::fit_check
