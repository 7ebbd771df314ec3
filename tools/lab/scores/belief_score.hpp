#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "tools/log/log_reader.hpp"

namespace palpate::scores {

/// How sure an estimator says it is, beside how far off it was.
struct BeliefScore {
  /// Share of nodes, over all shapes, whose error lies within the told 95 % interval: a ball of
  /// sqrt(chi2_3(0.95)) = 2.80 deviations. Empty where no deviation is told.
  std::optional<double> covered;
  double deviation = 0;  // m, mean over nodes and shapes
  struct Modulus {
    double time = 0;            // s since the first shape
    double young_modulus = 0;   // Pa
    double log_deviation = -1;  // below 0: not observable
    double moved = 0;           // s that a hand has moved by then
  };
  std::vector<Modulus> modulus;         // ten a second; empty where nothing estimates it
  std::optional<double> first_contact;  // s since the first shape: an unknown contact is told of
  double contact_share = 0;             // of the time
};

/// Throws std::runtime_error where the log lacks shape, truth or meshes.
BeliefScore score_belief(const log::RunLog& run);

nlohmann::json to_json(const BeliefScore& belief);

}  // namespace palpate::scores
