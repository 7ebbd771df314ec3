#pragma once

#include <optional>
#include <vector>

#include "core/sensing/input_domain.hpp"
#include "core/sensing/recurrent_network.hpp"
#include "tools/recordings/data_set.hpp"
#include "tools/recordings/plan.hpp"
#include "tools/train/trainer.hpp"

namespace palpate::train {

/// A network that was trained, and what it is compared with.
struct Fit {
  sensing::RecurrentWeights network;
  sensing::RecurrentWeights linear;  // the ridge regression of the same inputs alone
  Eigen::VectorXd penalty;           // of the ridge, per output
  sensing::InputDomain domain;       // of the network; without points where the plan has none
  Eigen::VectorXd trust;             // per output: by what the cells' part was multiplied
  int best_iteration = 0;
  std::vector<CurvePoint> curve;
};

struct FitOptions {
  bool all_parts = false;  // learn from validation and test parts too, to the last iteration
  Eigen::VectorXd trust;   // with it: that of the fit before
  std::function<bool(const CurvePoint&)> progress;  // false ends the training
  std::string checkpoint;
  bool resume = false;
  /// Network to go on from: its scales stay; the ridge and the cells learn what it leaves.
  const sensing::RecurrentWeights* start = nullptr;
};

/// Normalises on the training rows that count, fits the ridge and trains the cells: on what it
/// leaves where the plan has a linear path. Throws std::runtime_error where there is too little.
Fit fit_model(const recordings::Plan& plan, const recordings::DataSet& data, const FitOptions& options);

/// Answers for every row of every recording, streamed from its start; where `window` is above 0,
/// from a state of zero over the last `window` rows each (before the start: copies of the first).
/// They fade to zero outside of `domain`. With `only`, recordings without a row of that part are
/// not run; their answers are zero.
std::vector<Eigen::MatrixXd> predict(const sensing::RecurrentWeights& weights, const recordings::DataSet& data,
                                     int window = 0, const sensing::InputDomain& domain = {},
                                     std::optional<recordings::Part> only = {});

}  // namespace palpate::train
