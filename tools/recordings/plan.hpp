#pragma once

#include <string>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::recordings {

/// Columns of one kind.
struct ColumnGroup {
  std::string name;                  // for tables: "force"
  std::vector<std::string> columns;  // of the CSV, or names of observer_inputs()
  std::string unit;
  double floor =
      0;  // least deviation that they are divided by, in their unit (1 after unit_length)
  double unit_length = 0;  // inputs, above 0: divided by sqrt(|the group|^2 + unit_length^2) first
  bool is_direction = false;  // outputs: scored by angle
};

/// Half-open interval of time of a recording, s.
struct Interval {
  double begin = 0;
  double end = 0;
  bool contains(double t) const { return t >= begin && t < end; }
};

struct RecordingPlan {
  std::string file;    // below the folder of the data
  std::string column;  // that names the recordings of the file, one behind the other; empty: one
  std::vector<Interval> validation;
  std::vector<Interval> test;
  int validate_every = 0;  // above 0: each so many-th recording of the file is validation, whole
};

/// Where the signals of a wrist sensor stand, three (quaternion: four, w first) columns each.
struct WristColumns {
  std::vector<std::string> quaternion;    // sensor in W
  std::vector<std::string> velocity;      // m/s in W
  std::vector<std::string> rate;          // rad/s in S
  std::vector<std::string> acceleration;  // m/s^2 in S
  std::vector<std::string> force;         // N in S
  std::vector<std::string> torque;        // N m in S
  std::vector<std::string> position;      // m in W; may be empty where no input wants it
  std::vector<std::string> drifting;      // outputs whose bias drifts evenly along a recording
  bool acceleration_has_gravity = true;   // false: gravity was taken out of it
  double largest_delay = 0.2;             // s, that is looked for between streams
};

enum class Target {
  kMeasured,  // what was measured
  kResidual,  // minus what a rigid payload explains
};

struct DataPlan {
  bool is_wrist = false;
  std::string time;    // column, s
  double rate = 100;   // Hz, of the network's steps
  double average = 0;  // s, trailing mean of all columns; 0: the latest sample
  double tare = 0;     // s at the start of a recording, whose mean is zero; 0: none
  bool tare_outputs = true;
  double retare = 2;           // s at the start of a recording over which errors may be tared again
  std::string contact_column;  // only rows where it (tared) is above the threshold count
  double contact_threshold = 0;
  std::vector<ColumnGroup> inputs;
  std::vector<ColumnGroup> outputs;
  std::vector<RecordingPlan> recordings;
  WristColumns wrist;
  Target target = Target::kMeasured;
};

struct NetworkPlan {
  std::vector<int> layers{20};
  bool linear = true;  // a ridge regression beside the cells, which learn what it leaves
  /// Each output takes of the cells' part only what served it on the validation rows.
  bool shrink = false;
  /// Points that cover the training's inputs, away from which the network's answer fades; 0: none.
  int domain_points = 0;
  /// Where it begins to fade and where it is gone, in the distance within which all of them lie.
  double domain_near = 1;
  double domain_far = 2;
  std::vector<double> penalties{1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1, 10};
};

struct TrainingPlan {
  int seed = 1;
  int iterations = 1000;
  int evaluate_every = 25;  // iterations
  int patience = 10;        // evaluations without improvement after which it ends
  int lanes = 16;           // sequences at once
  int steps = 50;           // of truncated back-propagation
  bool carry = true;        // state from one piece of a sequence to the next; false: windows
  int burn_in = 10;         // first steps after a state of zero, which do not count
  double rate = 3e-3;       // of Adam; falls to a tenth along half a cosine
  double clip = 1;          // largest norm of the gradient
  double weight_decay = 0;
  double input_noise = 0;  // standard deviation, of normalised inputs
  bool keep_last = false;  // the cells of the last iteration, not those best on validation
  bool refit = false;      // the file holds a network trained once more on all parts
};

struct Plan {
  std::string name;
  std::string start_from;  // module that the training goes on from; empty: none
  DataPlan data;
  NetworkPlan network;
  TrainingPlan training;
};

/// Throws config::Error naming file, line, key and allowed range.
Plan read_plan(const config::Node& node);

/// Every column of groups in order, with its group's unit.
std::vector<std::string> columns_of(const std::vector<ColumnGroup>& groups);

}  // namespace palpate::recordings
