#pragma once

#include "core/estimation/consistency/explanations.hpp"
#include "core/estimation/wrench_update.hpp"

namespace palpate::estimation {

/// Permits the wrenches to correct the fused state only while they are consistent with the model.
/// When a discrepancy begins, the state falls back to what had been learnt before it, faded into
/// the shape; learning resumes when the discrepancy has ended, or when a slip of the grasp or a
/// bias of the sensor, which are states of the filter, explains it without reasonable doubt and has
/// been added to them. Nothing allocates after construction.
class LearningGuard {
 public:
  struct Options : WrenchConsistency::Options {
    bool enabled = false;  // whether the wrenches are tested at all
  };

  LearningGuard(const elasticity::Body& body, const mesh::Surface& surface,
                const WrenchSampling& sampling, const WrenchFilter::Options& priors,
                const Options& options);

  void reset() noexcept;
  /// Judges an innovation. `has_contact`: an external contact is suspected or estimated. True if it
  /// may correct the state.
  bool permits(const Innovation& now, bool has_contact, FusedState& state, WrenchUpdate& wrenches,
               const elasticity::DeformationModel& model) noexcept;
  /// Call once per tick: continues the ranking of explanations.
  void advance(double dt) noexcept;

  const WrenchConsistency& test() const noexcept { return test_; }
  /// nullptr: the wrenches are not tested.
  const DiscrepancyReport* report() const noexcept { return is_enabled_ ? &report_ : nullptr; }

 private:
  void fall_back(const Innovation& now, FusedState& state, WrenchUpdate& wrenches) const noexcept;
  void adopt(const CauseHypothesis& cause, const Innovation& now, FusedState& state,
             WrenchUpdate& wrenches) noexcept;

  bool is_enabled_;
  WrenchConsistency test_;
  Explanations explanations_;
  DiscrepancyReport report_;
  WrenchFilter prior_, initial_;       // initial: the prior, or the state after the last adoption
  std::vector<WrenchFilter> history_;  // ring, at the snapshots of the test
  int newest_ = 0;
};

}  // namespace palpate::estimation
