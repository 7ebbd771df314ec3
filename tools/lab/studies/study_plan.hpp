#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/runs/experiments.hpp"

namespace palpate::studies {

/// A published figure; `value` is "not available" if it could not be read from the source.
struct PublishedFigure {
  std::string quantity;
  std::string value;
};

/// A time at which the shape is evaluated, s since the first estimate.
struct StudyState {
  std::string name;
  double time = 0;
};

/// A task with an object, called an application in the thesis: an entry of a plan, such as
/// thesis.yaml.
struct StudyApplication {
  std::string name;
  std::string kind;   // force, control or tactile
  std::string note;   // for the reader of the report; may be empty
  bool quick = true;  // part of a quick run
  std::filesystem::path scene;
  std::filesystem::path configuration;
  std::vector<runs::Method> methods;
  std::vector<runs::Mismatch> levels;
  int object = 0, objects = 0;  // the object is this one of so many that are drawn; 0: not drawn
  std::vector<int> seeds;
  double duration = 0;                        // s, simulated
  std::vector<StudyState> states;             // empty: the poses that the hand holds
  std::vector<std::string> pose_names;        // of the scene's motion
  std::vector<Eigen::Vector3d> pose_points;   // in O, m; none or three
  std::optional<runs::ControlTarget> target;  // of kind control
  std::vector<PublishedFigure> published;
};

struct StudyPlan {
  double octree_resolution = 0;  // m
  std::vector<StudyApplication> applications;
};

/// Model errors in place of a plan's.
struct LevelSelection {
  std::vector<std::string> levels;  // names as in a plan; empty: the plan's
  int draws = 0;                    // of each distribution; 0: the plan's
  std::optional<int> draw_seed;     // of the draws
};

/// Reads a plan (thesis.yaml documents the keys) and the files that its entries name below `root`,
/// the source tree. A level of `mismatch` that names a file of distributions (calibrated) stands
/// for all its draws, one with a number (calibrated 17) for that draw. Throws config::Error that
/// names file and key.
StudyPlan read_study_plan(const std::filesystem::path& file, const std::filesystem::path& root,
                          const LevelSelection& levels = {});

/// One run: an application with one method, one level of model error and one seed.
struct StudyJob {
  std::string name;  // of its folder
  std::string application;
  std::string kind;
  std::string method;
  std::string mismatch;
  int seed = 0;
  std::filesystem::path scene;
  std::vector<std::string> scene_overrides;
  std::filesystem::path configuration;
  std::vector<std::string> daemon_overrides;
  double duration = 0;  // s, simulated
  std::vector<StudyState> states;
  std::vector<std::string> pose_names;
  std::vector<Eigen::Vector3d> pose_points;
  std::optional<runs::ControlTarget> target;
  double octree_resolution = 0;  // m
  bool real_time = false;
  std::string family;                   // of the model error, if it was drawn
  std::vector<runs::DrawnValue> drawn;  // its parameters
};

/// Selection of a plan's jobs.
struct StudySelection {
  std::vector<std::string> applications;  // names or parts of them; empty: all
  std::vector<int> seeds;                 // empty: those of the plan
  bool quick = false;                     // one seed, without entries that the plan excludes
  bool real_time = false;
};

/// Every application's methods, levels and seeds. Throws std::invalid_argument if a name of the
/// selection matches no application, or no job remains.
std::vector<StudyJob> study_jobs(const StudyPlan& plan, const StudySelection& selection);

}  // namespace palpate::studies
