#include "tools/lab/studies/discrepancy_wrench.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace palpate::studies {
namespace {

using math::Vector6d;

constexpr std::int64_t kWrenchWindow = 50000;  // us, as the estimator's test
constexpr double kNormalInterval = 1.96;       // deviations of a 95 % interval
// Below these a share is not meaningful: the sensor's noise.
constexpr double kLeastForce = 0.1, kLeastTorque = 0.02;  // N, N m

/// Wrench of one hand on the object in the plant's O, in palpated's.
Vector6d true_wrench(const truth_contact_t& truth, int hand, const math::Pose& X_OP) {
  const Eigen::Map<const Vector6d> wrench_P(truth.grasp_wrench[hand]);
  Vector6d wrench;
  wrench << X_OP.linear() * wrench_P.head<3>(), X_OP.linear() * wrench_P.tail<3>();
  return wrench;
}

/// Calls take(estimate, hand, error) for each estimate between two times whose truth is known.
template <class Take>
void visit_errors(const std::vector<truth_contact_t>& truth,
                  const std::vector<estimate_t>& estimates, const math::Pose& X_OP,
                  std::int64_t from, std::int64_t until, const Take& take) {
  for (const estimate_t& estimate : estimates) {
    if (estimate.utime < from || estimate.utime > until) continue;
    const truth_contact_t* now = log::latest(truth, estimate.utime);
    if (now == nullptr || estimate.utime - now->utime > kWrenchWindow) continue;
    for (int hand = 0; hand < std::min(now->grasp_count, estimate.grasp_count); ++hand) {
      const Eigen::Map<const Vector6d> predicted(estimate.reaction[hand]);
      take(estimate, hand, Vector6d(true_wrench(*now, hand, X_OP) - predicted));
    }
  }
}

/// Sum of one hand's errors and predictions in a window.
struct WrenchWindow {
  Vector6d error = Vector6d::Zero(), predicted = Vector6d::Zero();
  long count = 0;
  std::int64_t begin = 0;
};

/// Of force or torque (component / 3), at least what can be distinguished from zero.
Vector6d scale_of(const Vector6d& wrench) {
  Vector6d scale;
  scale.head<3>().setConstant(std::hypot(wrench.head<3>().norm(), kLeastForce));
  scale.tail<3>().setConstant(std::hypot(wrench.tail<3>().norm(), kLeastTorque));
  return scale;
}

/// Adds a window's mean and begins the next.
void close_window(WrenchWindow& window, int hand, WrenchError& total) {
  if (window.count == 0) return;
  const auto count = static_cast<double>(window.count);
  const Vector6d error = window.error / count,
                 share = error.cwiseQuotient(scale_of(window.predicted / count));
  const auto h = static_cast<std::size_t>(hand);
  total.mean_square[h] += error.cwiseAbs2();
  total.mean_square_share[h] += share.cwiseAbs2();
  total.largest[h] = total.largest[h].cwiseMax(error.cwiseAbs());
  total.largest_share[h] = total.largest_share[h].cwiseMax(share.cwiseAbs());
  if (hand == 0) ++total.windows;
  window = {};
}

}  // namespace

std::optional<double> largest_significance(const std::vector<discrepancy_t>& discrepancies,
                                           std::int64_t from, std::int64_t until) {
  std::optional<double> largest;
  for (const discrepancy_t& report : discrepancies) {
    if (report.utime < from || report.utime > until) continue;
    for (int hand = 0; hand < std::clamp(report.grasp_count, 0, 2); ++hand)
      for (int i = 0; i < 6; ++i) {
        if (!(report.deviation[hand][i] > 0)) continue;
        const double ratio = std::abs(report.difference[hand][i]) / report.deviation[hand][i];
        largest = std::max(largest.value_or(0), ratio);
      }
  }
  return largest;
}

WrenchError wrench_error(const std::vector<truth_contact_t>& truth,
                         const std::vector<estimate_t>& estimates, const math::Pose& X_OP,
                         std::int64_t from, std::int64_t until) {
  WrenchError total;
  std::array<WrenchWindow, 2> windows;
  visit_errors(truth, estimates, X_OP, from, until,
               [&](const estimate_t& estimate, int hand, const Vector6d& error) {
                 WrenchWindow& window = windows[static_cast<std::size_t>(hand)];
                 if (window.count > 0 && estimate.utime >= window.begin + kWrenchWindow)
                   close_window(window, hand, total);
                 if (window.count == 0) window.begin = estimate.utime;
                 window.error += error;
                 window.predicted += Eigen::Map<const Vector6d>(estimate.reaction[hand]);
                 ++window.count;
                 total.hands = std::max(total.hands, hand + 1);
               });
  for (int hand = 0; hand < total.hands; ++hand)
    close_window(windows[static_cast<std::size_t>(hand)], hand, total);
  if (total.windows == 0) return total;
  for (WrenchError::Components* sum : {&total.mean_square, &total.mean_square_share})
    for (Vector6d& of_hand : *sum) of_hand /= static_cast<double>(total.windows);
  return total;
}

nlohmann::json to_json(const WrenchError& error) {
  const auto values = [&error](const WrenchError::Components& components) {
    nlohmann::json json = nlohmann::json::array();
    for (int hand = 0; hand < error.hands; ++hand)
      for (const double value : components[static_cast<std::size_t>(hand)]) json.push_back(value);
    return json;
  };
  return {{"windows", error.windows},
          {"mean_square", values(error.mean_square)},
          {"mean_square_share", values(error.mean_square_share)},
          {"largest", values(error.largest)},
          {"largest_share", values(error.largest_share)}};
}

WrenchBelief wrench_belief(const std::vector<truth_contact_t>& truth,
                           const std::vector<estimate_t>& estimates, const math::Pose& X_OP,
                           std::int64_t from, std::int64_t until) {
  WrenchBelief belief;
  visit_errors(truth, estimates, X_OP, from, until,
               [&](const estimate_t& estimate, int hand, const Vector6d& error) {
                 for (int i = 0; i < 6; ++i) {
                   const double deviation = estimate.reaction_deviation[hand][i];
                   if (!(deviation > 0)) continue;
                   const double normalised = error[i] / deviation;
                   belief.share_inside += std::abs(normalised) <= kNormalInterval ? 1 : 0;
                   belief.normalised_square += normalised * normalised;
                   ++belief.count;
                 }
               });
  if (belief.count > 0) {
    belief.share_inside /= static_cast<double>(belief.count);
    belief.normalised_square /= static_cast<double>(belief.count);
  }
  return belief;
}

}  // namespace palpate::studies
