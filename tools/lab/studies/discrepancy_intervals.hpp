#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "tools/lab/scores/node_belief.hpp"
#include "tools/lab/studies/discrepancy_wrench.hpp"

namespace palpate::studies {

/// Errors of the node next to a fixed point of the object, so that worlds whose meshes differ can
/// be compared.
struct PointBelief {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // shares of the object's sides
  std::vector<double> errors, radii;                // m, at up to 20 instants; radii of 95 % balls
};

/// Reported deviations of shape, wrench and Young's modulus compared with their errors.
struct IntervalScore {
  scores::NodeBelief nodes;
  std::vector<PointBelief> points;
  WrenchBelief wrench;
  /// At the end of the log; empty if E is not estimated.
  std::optional<double> log_young_error, log_young_deviation;
};

/// From `from` (us) to the end of the log. X_OP: pose of the plant's O (P) in palpated's O; Young's
/// modulus of the plant in Pa. Throws std::runtime_error if the log lacks meshes.
IntervalScore score_intervals(const log::RunLog& log, const math::Pose& X_OP, double young_modulus,
                              std::int64_t from);

nlohmann::json to_json(const IntervalScore& score);

}  // namespace palpate::studies
