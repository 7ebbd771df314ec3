#pragma once

#include "core/estimation/wrench_consistency.hpp"
#include "core/estimation/wrench_update.hpp"

namespace palpate::estimation {

/// Permits the wrenches to correct the fused state only while they are consistent with the model.
/// When a discrepancy begins, the state falls back to what had been learnt before it, faded into
/// the shape; learning resumes when the discrepancy has ended. Nothing allocates after
/// construction.
class LearningGuard {
 public:
  struct Options : WrenchConsistency::Options {
    bool enabled = false;  // whether the wrenches are tested at all
  };

  LearningGuard(const elasticity::Body& body, const WrenchSampling& sampling,
                const WrenchFilter::Options& priors, const Options& options);

  void reset() noexcept;
  /// Judges an innovation. `has_contact`: an external contact is suspected or estimated. True if it
  /// may correct the state.
  bool permits(const Innovation& now, bool has_contact, FusedState& state, WrenchUpdate& wrenches,
               const elasticity::DeformationModel& model) noexcept;

  const WrenchConsistency& test() const noexcept { return test_; }

 private:
  void fall_back(const Innovation& now, FusedState& state, WrenchUpdate& wrenches) const noexcept;

  bool is_enabled_;
  WrenchConsistency test_;
  WrenchFilter prior_;
  std::vector<WrenchFilter> history_;  // ring, at the snapshots of the test
  int newest_ = 0;
};

}  // namespace palpate::estimation
