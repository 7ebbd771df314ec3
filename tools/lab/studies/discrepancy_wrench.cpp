#include "tools/lab/studies/discrepancy_wrench.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::studies {
namespace {

using math::Vector6d;

constexpr std::int64_t kSameTimeUs = 50000;  // us
constexpr double kNormalInterval = 1.96;     // deviations of a 95 % interval

/// Wrench of one hand on the object in the plant's O, in palpated's.
Vector6d true_wrench(const truth_contact_t& truth, int hand, const math::Pose& X_OP) {
  const Eigen::Map<const Vector6d> wrench_P(truth.grasp_wrench[hand]);
  Vector6d wrench;
  wrench << X_OP.linear() * wrench_P.head<3>(), X_OP.linear() * wrench_P.tail<3>();
  return wrench;
}

}  // namespace

WrenchBelief wrench_belief(const std::vector<truth_contact_t>& truth,
                           const std::vector<estimate_t>& estimates, const math::Pose& X_OP,
                           std::int64_t from, std::int64_t until) {
  WrenchBelief belief;
  for (const estimate_t& estimate : estimates) {
    if (estimate.utime < from || estimate.utime > until) continue;
    const truth_contact_t* now = log::latest(truth, estimate.utime);
    if (now == nullptr || estimate.utime - now->utime > kSameTimeUs) continue;
    for (int hand = 0; hand < std::min(now->grasp_count, estimate.grasp_count); ++hand) {
      const Eigen::Map<const Vector6d> predicted(estimate.reaction[hand]);
      const Vector6d error = true_wrench(*now, hand, X_OP) - predicted;
      for (int i = 0; i < 6; ++i) {
        const double deviation = estimate.reaction_deviation[hand][i];
        if (!(deviation > 0)) continue;
        const double normalised = error[i] / deviation;
        belief.share_inside += std::abs(normalised) <= kNormalInterval ? 1 : 0;
        belief.normalised_square += normalised * normalised;
        ++belief.count;
      }
    }
  }
  if (belief.count > 0) {
    belief.share_inside /= static_cast<double>(belief.count);
    belief.normalised_square /= static_cast<double>(belief.count);
  }
  return belief;
}

}  // namespace palpate::studies
