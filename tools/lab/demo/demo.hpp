#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/lab/runs/experiments.hpp"
#include "tools/lab/scores/report.hpp"

namespace palpate::demo {

struct DemoOptions {
  std::filesystem::path output;  // folder of logs, images, plots and summary.json
  std::filesystem::path root;    // source tree: scenes, configurations, tools/lab/studies/*.yaml
  std::filesystem::path data;    // recordings; may be absent
  std::vector<std::string> stages{"sensing", "control", "recording"};
  std::vector<std::string>
      scene_overrides;  // of every scene, applied before those of a model error
  std::vector<std::string> daemon_overrides;  // of palpated, likewise
  std::filesystem::path json;                 // copy of summary.json; empty: none
};

/// Runs the applications of the thesis one after the other, each as simulator (or player) and
/// daemon over LCM; prints the table and writes summary.json, plots and images. Returns the exit
/// code: 0, or 1 if a run failed or missed a bound.
int run_demo(const DemoOptions& options);

/// State shared by the stages.
struct Demo {
  DemoOptions options;
  int runs = 0;  // number of live runs, total and done, for the progress line
  int begun = 0;
  std::vector<scores::ScoredRun> scored;

  std::filesystem::path file(const std::string& in_source_tree) const {
    return options.root / in_source_tree;
  }
  std::filesystem::path log_folder(const std::string& run) const;
  /// A level of mismatch.yaml, or a draw ("calibrated 3": one of a hundred), for these files of the
  /// source tree, in addition to the overrides given by the user.
  runs::Mismatch mismatch(const std::string& level, const std::string& scene,
                          const std::string& configuration) const;
};

/// Each stage appends one ScoredRun per run; a failure is stored in it, Interrupted propagates.
void run_sensing(Demo& demo);
void run_control(Demo& demo);
void run_recording(Demo& demo);

/// Number of live runs of a stage.
int count_sensing(const Demo& demo);
int count_control(const Demo& demo);
int count_recording(const Demo& demo);

}  // namespace palpate::demo
