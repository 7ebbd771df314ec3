#pragma once

#include <optional>
#include <vector>

#include "core/sensing/input_domain.hpp"
#include "core/sensing/recurrent_network.hpp"
#include "tools/recordings/data_set.hpp"
#include "tools/recordings/plan.hpp"
#include "tools/train/trainer.hpp"

namespace palpate::train {

/// A trained network, and its baseline.
struct Fit {
  sensing::RecurrentWeights network;
  sensing::RecurrentWeights linear;  // baseline: the ridge regression of the same inputs alone
  Eigen::VectorXd penalty;           // of the ridge, per output
  sensing::InputDomain domain;       // of the network; without points if the plan has none
  Eigen::VectorXd trust;             // per output: factor on the cells' part
  int best_iteration = 0;
  std::vector<CurvePoint> curve;
};

struct FitOptions {
  bool all_parts = false;  // train on validation and test parts too, to the last iteration
  Eigen::VectorXd trust;   // with it: that of the fit before
  std::function<bool(const CurvePoint&)> progress;  // returning false ends the training
  std::string checkpoint;
  bool resume = false;
  /// Initial network: its scales are kept; the ridge and the cells learn its residual.
  const sensing::RecurrentWeights* start = nullptr;
};

/// Normalises on the training rows that count, fits the ridge and trains the cells: on its residual
/// if the plan has a linear path. Throws std::runtime_error if there are too few data.
Fit fit_model(const recordings::Plan& plan, const recordings::DataSet& data,
              const FitOptions& options);

/// Predictions for every row of every recording, streamed from its start; if `window` is above 0,
/// from a zero state over the last `window` rows each (padded before the start with copies of the
/// first). They fade to zero outside of `domain`. With `only`, recordings without a row of that
/// part are skipped; their predictions are zero.
std::vector<Eigen::MatrixXd> predict(const sensing::RecurrentWeights& weights,
                                     const recordings::DataSet& data, int window = 0,
                                     const sensing::InputDomain& domain = {},
                                     std::optional<recordings::Part> only = {});

}  // namespace palpate::train
