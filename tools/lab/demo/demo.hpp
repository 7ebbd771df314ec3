#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/lab/runs/experiments.hpp"
#include "tools/lab/scores/report.hpp"

namespace palpate::demo {

struct DemoOptions {
  std::filesystem::path output;  // folder of logs, pictures, plots and summary.json
  std::filesystem::path root;    // source tree: scenes, configurations, tools/lab/studies/*.yaml
  std::filesystem::path data;    // recordings; may be absent
  std::vector<std::string> stages{"sensing", "control", "recording"};
  std::vector<std::string> scene_overrides;   // of every scene, before those of a model error
  std::vector<std::string> daemon_overrides;  // of palpated beside the simulator, likewise
  std::filesystem::path json;                 // a copy of summary.json; empty: none
};

/// The applications of the thesis, one after the other, each as simulator (or player) and daemon
/// over LCM; prints the table and writes summary.json, plots and pictures. Returns the exit code:
/// 0, or 1 where a run failed or missed a figure that it has to meet.
int run_demo(const DemoOptions& options);

/// What the stages share.
struct Demo {
  DemoOptions options;
  int runs = 0;  // live ones to come and done, for the progress line
  int begun = 0;
  std::vector<scores::ScoredRun> scored;

  std::filesystem::path file(const std::string& in_source_tree) const {
    return options.root / in_source_tree;
  }
  std::filesystem::path log_folder(const std::string& run) const;
  /// A level of mismatch.yaml, for these files of the source tree, on top of the overrides that the
  /// user gave.
  runs::Mismatch mismatch(const std::string& level, const std::string& scene,
                          const std::string& configuration) const;
};

/// Each stage appends one ScoredRun a run; a failure is kept in it, Interrupted passes through.
void run_sensing(Demo& demo);
void run_control(Demo& demo);
void run_recording(Demo& demo);

/// Live runs that a stage starts.
int count_sensing(const Demo& demo);
int count_control(const Demo& demo);
int count_recording(const Demo& demo);

}  // namespace palpate::demo
