#pragma once

#include <memory>
#include <utility>

#include "core/estimation/estimator.hpp"

namespace palpate::support {

/// What a DoubtfulEstimator reports; the test changes it between cycles.
struct Doubt {
  UpdateResult result;
  estimation::DiscrepancyReport report;
  bool has_report = true;
  bool has_contact = false;
};

/// An estimator that forwards to the wrapped one and reports what the test says. A result other
/// than kOk replaces that of the wrapped estimator.
class DoubtfulEstimator final : public estimation::Estimator {
 public:
  DoubtfulEstimator(std::unique_ptr<estimation::Estimator> good, const Doubt& doubt)
      : good_(std::move(good)), doubt_(doubt) {}
  void activate(elasticity::DeformationModel& model) noexcept override { good_->activate(model); }
  UpdateResult update(const estimation::EstimationInputs& inputs,
                      elasticity::DeformationModel& model,
                      estimation::Estimate& estimate) noexcept override {
    const UpdateResult result = good_->update(inputs, model, estimate);
    estimate.discrepancy = doubt_.has_report ? &doubt_.report : nullptr;
    estimate.unknown_contact.found = doubt_.has_contact;
    return doubt_.result.is_ok() ? result : doubt_.result;
  }
  void reset() noexcept override { good_->reset(); }

 private:
  std::unique_ptr<estimation::Estimator> good_;
  const Doubt& doubt_;
};

}  // namespace palpate::support
