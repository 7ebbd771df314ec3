#include "rt/pipeline/estimate_trust.hpp"

#include <cmath>
#include <cstdio>

namespace palpate::pipeline {
namespace {

using control::DiscrepancyAction;

/// Whether the estimated external force leaves no significant difference of the wrenches. The
/// discrepancy itself ends some time later, after its own tests.
bool has_explanation(const estimation::Estimate& estimate) noexcept {
  const estimation::DiscrepancyReport* report = estimate.discrepancy;
  return estimate.unknown_contact.found &&
         (report == nullptr || !(report->test > report->threshold));
}

}  // namespace

void EstimateTrust::judge(const UpdateResult& result, const estimation::Estimate& estimate,
                          const control::DiscrepancyPolicy::Options& policy,
                          Condition& condition) noexcept {
  const bool is_inconsistent =
      result.status == Status::kDoubtful ||
      (estimate.discrepancy != nullptr && estimate.discrepancy->is_inconsistent);
  const bool is_explained = is_inconsistent && has_explanation(estimate);
  is_in_doubt_ = is_inconsistent && !is_explained;
  is_usable_ = result.is_ok() || result.status == Status::kDoubtful;
  if (!is_usable_ || !is_inconsistent) {
    condition.apply(result);
    return;
  }
  const char* what = result.is_ok() ? "the wrenches contradict the model" : result.reason;
  if (is_explained) {
    std::snprintf(text_.data(), text_.size(), "%s: an external contact explains it", what);
  } else if (policy.action == DiscrepancyAction::kContinue) {
    std::snprintf(text_.data(), text_.size(), "%s: control continues", what);
  } else if (policy.action == DiscrepancyAction::kStop) {
    std::snprintf(text_.data(), text_.size(), "%s: control stopped", what);
  } else {
    std::snprintf(text_.data(), text_.size(), "%s: control slowed to %d %%", what,
                  static_cast<int>(std::lround(100 * policy.speed)));
  }
  condition.apply({Status::kDegraded, text_.data()});
}

}  // namespace palpate::pipeline
