#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::studies {

/// Largest |difference| / deviation of DISCREPANCY between two times (us), over hands and
/// components; empty if it gives none.
std::optional<double> largest_significance(const std::vector<discrepancy_t>& discrepancies,
                                           std::int64_t from, std::int64_t until);

/// True wrench minus the one that an estimate predicts, of each hand at G in O: means over windows
/// of 50 ms. Components: force x, y, z, torque x, y, z. N and N m; a share is of the predicted
/// force or torque.
struct WrenchError {
  using Components = std::array<math::Vector6d, 2>;
  int hands = 0;
  long windows = 0;
  Components mean_square{math::Vector6d::Zero(), math::Vector6d::Zero()};
  Components mean_square_share = mean_square;
  Components largest = mean_square, largest_share = mean_square;
};

/// Between two times (us). X_OP: pose of the plant's O (P) in palpated's O.
WrenchError wrench_error(const std::vector<truth_contact_t>& truth,
                         const std::vector<estimate_t>& estimates, const math::Pose& X_OP,
                         std::int64_t from, std::int64_t until);

nlohmann::json to_json(const WrenchError& error);

/// Reported deviations of the wrench compared with its errors, over hands and components.
struct WrenchBelief {
  long count = 0;                // components with a reported deviation
  double share_inside = 0;       // within 1.96 deviations
  double normalised_square = 0;  // mean of squared error over variance
};

WrenchBelief wrench_belief(const std::vector<truth_contact_t>& truth,
                           const std::vector<estimate_t>& estimates, const math::Pose& X_OP,
                           std::int64_t from, std::int64_t until);

}  // namespace palpate::studies
