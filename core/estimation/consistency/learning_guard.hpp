#pragma once

#include "core/estimation/consistency/explanations.hpp"
#include "core/estimation/wrench_update.hpp"

namespace palpate::estimation {

/// Learns the fused state from the wrenches while they are consistent with the model: the state
/// follows what the test knows of it, which accounts for the errors of the model. When a
/// discrepancy begins, the state falls back to what had been learnt before it, faded into the
/// shape; learning resumes when the discrepancy has ended, or when a slip of the grasp or a bias of
/// the sensor, which are states of the filter, explains it without reasonable doubt and has been
/// added to them. Once the shape is observed, virtual loads belong to the state, and the filter's
/// own update learns instead. Nothing allocates after construction.
class LearningGuard {
 public:
  struct Options : WrenchConsistency::Options {
    bool enabled = true;  // whether the wrenches are tested, and learnt from in this way
  };

  LearningGuard(const elasticity::Body& body, const mesh::Surface& surface,
                const WrenchSampling& sampling, const WrenchFilter::Options& priors,
                const Options& options);

  void reset() noexcept;
  /// Begins with the state of the filter.
  void take_over(const WrenchFilter& filter) noexcept;
  /// Judges an innovation, and learns from it. `has_contact`: an external contact is suspected or
  /// estimated. True if the filter's own update may correct the state.
  bool permits(const Innovation& now, bool has_contact, FusedState& state, WrenchUpdate& wrenches,
               const elasticity::DeformationModel& model) noexcept;
  /// Call once per tick: continues the ranking of explanations.
  void advance(double dt) noexcept;

  const WrenchConsistency& test() const noexcept { return test_; }
  /// nullptr: the wrenches are not tested.
  const DiscrepancyReport* report() const noexcept { return is_enabled_ ? &report_ : nullptr; }

 private:
  void assume(const Innovation& now, bool is_faded, FusedState& state,
              WrenchUpdate& wrenches) const noexcept;

  bool is_enabled_;
  WrenchConsistency test_;
  Explanations explanations_;
  DiscrepancyReport report_;
};

}  // namespace palpate::estimation
