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
  std::vector<Eigen::Vector3d> markers;  // rest points of the plant, seen 100 times a second
  /// In each message beside the sensor's own: of the greatest force and torque between hand and
  /// object, and of the markers' greatest way.
  double noise = 0.01;
  int seed = 1;
};

/// Lets the scene's motion run to its end and writes ROBOT_STATE, FT_WRENCH and, where there are
/// markers, SHAPE_OBSERVATION to an LCM log. `progress`: share done. Throws config::Error and
/// std::runtime_error.
void record(const SimulatedRecording& recording, const std::string& log,
            const std::function<void(double)>& progress = {});

/// What a fit to simulated recordings found of what the plant is made of.
struct Statement {
  std::string parameter;
  double truth = 0, found = 0, low = 0, high = 0;
  double error = 0;  // of found: relative, of Poisson's ratio absolute
  double bar = 0;    // that the error is to stay within
  bool is_met() const { return error <= bar; }
};

struct StatementOptions {
  std::string folder;                  // for logs
  std::vector<std::string> overrides;  // of the scenes
  std::string cells = "[20, 2, 2]";    // of the mesh that is fitted, quadratic
  std::function<void(const std::string& what, double share)> progress;
};

/// Young's modulus and Poisson's ratio from bar_rests.yaml, its width seen by markers; damping from
/// bar_stops.yaml. The plant is Neo-Hookean, on hexahedra; what is fitted is palpated's model, that
/// begins 30 % off. Throws as record() does, and std::runtime_error where a fit fails.
std::vector<Statement> fit_simulated(const StatementOptions& options);

}  // namespace palpate::fit_check
