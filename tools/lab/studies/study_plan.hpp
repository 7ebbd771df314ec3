#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/runs/experiments.hpp"

namespace palpate::studies {

/// A figure that others have published; `value` is "not available" where nobody could read it.
struct PublishedFigure {
  std::string quantity;
  std::string value;
};

/// A time at which the shape is looked at, s since the first estimate.
struct StudyState {
  std::string name;
  double time = 0;
};

/// What is done with an object, as the thesis calls it: an entry of a plan, such as thesis.yaml.
struct StudyApplication {
  std::string name;
  std::string kind;   // force, control or tactile
  std::string note;   // for the reader of the report; may be empty
  bool quick = true;  // part of a quick run
  std::filesystem::path scene;
  std::filesystem::path configuration;
  std::vector<runs::Method> methods;
  std::vector<runs::Mismatch> levels;
  std::vector<int> seeds;
  double duration = 0;                        // s, simulated
  std::vector<StudyState> states;             // none: the poses that the hand holds
  std::vector<std::string> pose_names;        // of the scene's motion
  std::vector<Eigen::Vector3d> pose_points;   // in O, m; none or three
  std::optional<runs::ControlTarget> target;  // of kind control
  std::vector<PublishedFigure> published;
};

struct StudyPlan {
  double octree_resolution = 0;  // m
  std::vector<StudyApplication> applications;
};

/// Reads a plan (thesis.yaml says what it may hold) and what its entries name below `root`, the
/// source tree. Throws config::Error that names file and key.
StudyPlan read_study_plan(const std::filesystem::path& file, const std::filesystem::path& root);

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
};

/// What of a plan is run.
struct StudySelection {
  std::vector<std::string> applications;  // names or parts of them; none: all
  std::vector<int> seeds;                 // none: those of the plan
  bool quick = false;                     // one seed, without what the plan leaves out then
  bool real_time = false;
};

/// Every application's methods, levels and seeds. Throws std::invalid_argument where a name of the
/// selection fits no application, or nothing is left to run.
std::vector<StudyJob> study_jobs(const StudyPlan& plan, const StudySelection& selection);

}  // namespace palpate::studies
