#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "core/sensing/recurrent_network.hpp"
#include "tools/recordings/plan.hpp"

namespace palpate::train {

/// Rows in a row of one recording, scaled: what the cells see and what they are to answer.
struct Sequence {
  Eigen::MatrixXf inputs;   // n x inputs
  Eigen::MatrixXf targets;  // n x outputs
  Eigen::VectorXf weights;  // n: 1, or 0 for rows that are not learned
};

/// Cells and the dense map behind them; `dense` and `offset` in units of the targets.
struct Cells {
  std::vector<sensing::LstmWeights> layers;
  Eigen::MatrixXf dense;
  Eigen::VectorXf offset;
};

struct CurvePoint {
  int iteration = 0;
  double training = 0;    // mean squared error of scaled targets since the point before
  double validation = 0;  // as the caller measures it; NaN: not at all
};

struct TrainerResult {
  Cells cells;  // the best on validation, or the last
  int best_iteration = 0;
  std::vector<CurvePoint> curve;
};

struct TrainerHooks {
  std::function<double(const Cells&)> validate;
  /// After each validation; false ends the training.
  std::function<bool(const CurvePoint&)> progress;
  /// File that holds all that is needed to go on, rewritten at each validation; empty: none.
  std::string checkpoint;
  bool resume = false;           // from it, where it is there
  bool start_at_zero = false;    // the dense map is zero at first
  const Cells* start = nullptr;  // cells to go on from, of the same layers
};

/// Truncated back-propagation through time with Adam. The same seed and data give the same cells,
/// also across a stop and a resumption. Throws std::runtime_error where there is nothing to learn
/// from, the loss is not finite, or the checkpoint belongs to another plan.
TrainerResult train_cells(const std::vector<Sequence>& sequences, const std::vector<int>& layers,
                          const recordings::TrainingPlan& plan, const TrainerHooks& hooks);

}  // namespace palpate::train
