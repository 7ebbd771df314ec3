#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace palpate::sensor_models {

struct ObserverOptions {
  std::filesystem::path root;         // source tree
  std::filesystem::path output;       // folder for recordings, models, logs, plots
  std::filesystem::path json;         // beside output/observer.json; empty: none
  std::string executor = "compiled";  // of the learned models, or torch
  int iterations = 0;                 // of training; 0: what the presets say
  int recordings = 3;                 // to learn from, of each of slow and quick motion
  double longest = 0;                 // s, at which every recording is cut off; 0: never
  bool keep = false;                  // recordings to learn from and models that are there already
  /// Names of test motions; empty: all of manual, rotation_y, rotation_z, collision.
  std::vector<std::string> motions;
  /// Names of models; empty: all of newton_euler, newton_euler_smooth (with a
  /// low-pass), ft_rnnob, thesis.
  std::vector<std::string> models;
};

/// The thesis' experiments with the observer of the wrist sensor (section 3.4), in simulation, with
/// palpate's own programs: records the payload arm, trains with palpate-train, runs the daemon over
/// motions never seen with palpate-replay, scores what it says is contact. Prints a table, writes
/// observer.csv, observer.json and plots to the output folder. The payload of Newton and Euler's
/// model is that identified from the same recordings. Exit code 1 where the residual without
/// contact exceeds 2 % of the payload's weight or the collision is off by more than 5 % of its
/// peak with the model ft_rnnob. Throws as the programs fail.
int run_observer(const ObserverOptions& options, std::ostream& out);

/// The command observer.
class ObserverCommand {
 public:
  explicit ObserverCommand(CLI::App& app);
  /// Runs it where it was given and returns the exit code.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out);

 private:
  ObserverOptions options_;
  CLI::App* command_;
};

}  // namespace palpate::sensor_models
