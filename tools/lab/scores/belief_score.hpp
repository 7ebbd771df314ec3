#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::scores {

/// Reported uncertainty of an estimator compared with its actual error.
struct BeliefScore {
  /// Fraction of nodes, over all shapes, whose error lies within the reported 95 % region: a ball
  /// of sqrt(chi2_3(0.95)) = 2.80 standard deviations. Empty if no deviation is reported.
  std::optional<double> covered;
  double deviation = 0;  // m, mean over nodes and shapes
  struct Modulus {
    double time = 0;            // s since the first shape
    double young_modulus = 0;   // Pa
    double log_deviation = -1;  // negative: not observable
    double moved = 0;           // s, accumulated time of hand motion
  };
  std::vector<Modulus> modulus;         // at 10 Hz; empty if it is not estimated
  std::optional<double> first_contact;  // s since the first shape: an unknown contact is reported
  double contact_share = 0;             // of the time
};

/// Whether the estimate reports an unknown contact.
inline bool reports_contact(const estimate_t& estimate) {
  return estimate.unknown_contact_deviation >= 0;
}

/// X_OP: pose of the plant's O (P) in palpated's O. Throws std::runtime_error if the log lacks
/// shape, truth or meshes.
BeliefScore score_belief(const log::RunLog& run, const math::Pose& X_OP = math::Pose::Identity());

nlohmann::json to_json(const BeliefScore& belief);

}  // namespace palpate::scores
