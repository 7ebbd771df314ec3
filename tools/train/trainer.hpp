#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "core/sensing/recurrent_network.hpp"
#include "tools/recordings/plan.hpp"

namespace palpate::train {

/// Consecutive rows of one recording, scaled: inputs and targets of the cells.
struct Sequence {
  Eigen::MatrixXf inputs;   // n x inputs
  Eigen::MatrixXf targets;  // n x outputs
  Eigen::VectorXf weights;  // n: 1, or 0 for rows that are not used
};

/// Cells and the dense map after them; `dense` and `offset` in units of the targets.
struct Cells {
  std::vector<sensing::LstmWeights> layers;
  Eigen::MatrixXf dense;
  Eigen::VectorXf offset;
};

struct CurvePoint {
  int iteration = 0;
  double training = 0;    // mean squared error of scaled targets since the previous point
  double validation = 0;  // as measured by the caller; NaN: not measured
};

struct TrainerResult {
  Cells cells;  // the best on validation, or the last
  int best_iteration = 0;
  std::vector<CurvePoint> curve;
};

struct TrainerHooks {
  std::function<double(const Cells&)> validate;
  /// Called after each validation; returning false ends the training.
  std::function<bool(const CurvePoint&)> progress;
  /// File with everything needed to resume, rewritten at each validation; empty: none.
  std::string checkpoint;
  bool resume = false;           // resume from it, if it exists
  bool start_at_zero = false;    // the dense map is initialised to zero
  const Cells* start = nullptr;  // initial cells, of the same layers
};

/// Truncated back-propagation through time with Adam. The same seed and data give the same cells,
/// also across an interruption. Throws std::runtime_error if there are no training data, the loss
/// is not finite, or the checkpoint belongs to another plan.
TrainerResult train_cells(const std::vector<Sequence>& sequences, const std::vector<int>& layers,
                          const recordings::TrainingPlan& plan, const TrainerHooks& hooks);

}  // namespace palpate::train
