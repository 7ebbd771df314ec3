#pragma once

#include <cstdint>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::studies {

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
