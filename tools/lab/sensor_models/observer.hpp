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
  std::filesystem::path json;         // copy of output/observer.json; empty: none
  std::string executor = "compiled";  // of the learned models, or torch
  int iterations = 0;                 // of training; 0: those of the presets
  int recordings = 3;                 // training recordings, of slow and of quick motion each
  double longest = 0;                 // s, maximum length of every recording; 0: unlimited
  bool keep = false;                  // existing training recordings and models
  /// Names of test motions; empty: all of manual, rotation_y, rotation_z, collision.
  std::vector<std::string> motions;
  /// Names of models; empty: all of newton_euler, newton_euler_smooth (with a
  /// low-pass), ft_rnnob, thesis.
  std::vector<std::string> models;
};

/// The thesis' experiments with the observer of the wrist sensor (section 3.4), in simulation, with
/// palpate's own programs: records the payload arm, trains with palpate-train, runs the daemon over
/// unseen motions with palpate-replay, scores its contact wrench. Prints a table, writes
/// observer.csv, observer.json and plots to the output folder. The payload of the Newton-Euler
/// model is identified from the same recordings. Exit code 1 if the residual without contact
/// exceeds 2 % of the payload's weight or the collision is off by more than 5 % of its peak with
/// the model ft_rnnob. Throws if one of the programs fails.
int run_observer(const ObserverOptions& options, std::ostream& out);

/// The command observer.
class ObserverCommand {
 public:
  explicit ObserverCommand(CLI::App& app);
  /// Runs the command if it was given and returns the exit code.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out);

 private:
  ObserverOptions options_;
  CLI::App* command_;
};

}  // namespace palpate::sensor_models
