#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tools/lab/studies/study_report.hpp"

namespace palpate::studies {

/// A command that runs a plan: every method under every model error with every seed.
struct Study {
  std::string name;              // of the command and its JSON file
  std::string title;             // of the report
  std::string about;             // for --help
  std::filesystem::path plan;    // its default plan, below the source tree
  std::filesystem::path output;  // its default folder
  /// False: each job is simulated with the daemon in the loop. True: the hand's motion does not
  /// depend on the estimate (kinds force and tactile), so that each application is simulated once
  /// for each level and seed, and every method runs on that recording (palpate-replay).
  bool replayed = false;
};

/// Runs, scores and reports a study.
class StudyCommand {
 public:
  StudyCommand(CLI::App& app, Study study);
  ~StudyCommand();

  /// Runs the command if it was given and returns the exit code: 0, or 1 if a job failed. `root`:
  /// the source tree. Throws config::Error for an invalid plan, std::invalid_argument for a
  /// replayed study with an application of kind control, and Interrupted.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out);

 private:
  struct Options;
  class Hashes;
  struct Work;
  void run_one(const std::vector<StudyJob>& jobs, const Hashes& hashes) const;
  Work work_of(const std::vector<StudyJob>& jobs, const Hashes& hashes,
               const std::filesystem::path& root, const std::filesystem::path& plan_file) const;
  /// Runs the work and enters failures into the report.
  void run_work(const Work& work, StudyReport& report, std::ostream& out) const;
  Study study_;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace palpate::studies
