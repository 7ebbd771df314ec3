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
      0;  // least standard deviation used as divisor, in their unit (1 after unit_length)
  double unit_length = 0;  // inputs, if > 0: divided by sqrt(|the group|^2 + unit_length^2) first
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
  std::string column;  // column that distinguishes consecutive recordings in the file; empty: one
  std::vector<Interval> validation;
  std::vector<Interval> test;
  int validate_every =
      0;  // if > 0: every n-th recording of the file is used for validation as a whole
};

/// Columns of the signals of a wrist sensor, three (quaternion: four, w first) each.
struct WristColumns {
  std::vector<std::string> quaternion;    // sensor in W
  std::vector<std::string> velocity;      // m/s in W
  std::vector<std::string> rate;          // rad/s in S
  std::vector<std::string> acceleration;  // m/s^2 in S
  std::vector<std::string> force;         // N in S
  std::vector<std::string> torque;        // N m in S
  std::vector<std::string> position;      // m in W; may be empty if no input uses it
  std::vector<std::string> drifting;  // outputs with a linear drift of the bias along a recording
  bool acceleration_has_gravity = true;  // false: gravity was removed from it
  double largest_delay = 0.2;            // s, search range between streams
};

enum class Target {
  kMeasured,  // the measured wrench
  kResidual,  // minus the wrench explained by a rigid payload
};

struct DataPlan {
  bool is_wrist = false;
  std::string time;    // column, s
  double rate = 100;   // Hz, of the network's steps
  double average = 0;  // s, trailing mean of all columns; 0: the latest sample
  double tare = 0;     // s at the start of a recording whose mean is subtracted; 0: none
  bool tare_outputs = true;
  double retare = 2;           // s at the start of a recording over which errors may be tared again
  std::string contact_column;  // only rows in which it (tared) is above the threshold count
  double contact_threshold = 0;
  std::vector<ColumnGroup> inputs;
  std::vector<ColumnGroup> outputs;
  std::vector<RecordingPlan> recordings;
  WristColumns wrist;
  Target target = Target::kMeasured;
};

struct NetworkPlan {
  std::vector<int> layers{20};
  bool linear = true;  // a ridge regression in parallel with the cells, which learn its residual
  /// Each output uses only the fraction of the cells' part that improved the validation rows.
  bool shrink = false;
  /// Points that cover the training inputs, away from which the network's output fades; 0: none.
  int domain_points = 0;
  /// Distances at which it begins to fade and is zero, relative to the distance within which all of
  /// them lie.
  double domain_near = 1;
  double domain_far = 2;
  std::vector<double> penalties{1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1, 10};
};

struct TrainingPlan {
  int seed = 1;
  int iterations = 1000;
  int evaluate_every = 25;  // iterations
  int patience = 10;        // evaluations without improvement before early stopping
  int lanes = 16;           // batch size, sequences
  int steps = 50;           // steps of truncated back-propagation
  bool carry = true;   // carries the state from one piece of a sequence to the next; false: windows
  int burn_in = 10;    // first steps after a zero state, which do not count
  double rate = 3e-3;  // of Adam; decays to a tenth along half a cosine
  double clip = 1;     // largest norm of the gradient
  double weight_decay = 0;
  double input_noise = 0;  // standard deviation, of normalised inputs
  bool keep_last = false;  // the cells of the last iteration, not the best on validation
  bool refit = false;      // the file holds a network trained again on all parts
};

struct Plan {
  std::string name;
  std::string start_from;  // module from which the training continues; empty: none
  DataPlan data;
  NetworkPlan network;
  TrainingPlan training;
};

/// Throws config::Error naming file, line, key and allowed range.
Plan read_plan(const config::Node& node);

/// Every column of groups in order, with its group's unit.
std::vector<std::string> columns_of(const std::vector<ColumnGroup>& groups);

}  // namespace palpate::recordings
