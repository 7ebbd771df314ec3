#pragma once

#include "core/estimation/consistency/cause_responses.hpp"
#include "core/estimation/discrepancy_report.hpp"

namespace palpate::estimation {

/// Measured wrenches over a short time, and how they depend on what the model may lack.
struct CauseRecord {
  WrenchRecord hands;
  std::array<CauseResponses::Hand, 2> responses;
  std::array<Eigen::Vector3d, CauseResponses::kPlaces> inward;
  Eigen::Vector3d gravity;  // unit vector
  /// N, N m: measured minus predicted wrench for the knowledge of the states, and its change since
  /// the record before.
  std::array<math::Vector6d, 2> difference, change;
};
inline constexpr double kRecordPeriod = 0.1;  // s

/// A cause of a discrepancy with states of its own, estimated along with WrenchStates; the
/// likelihood of the measured wrenches ranks it among others. Nothing allocates after construction.
class CauseHypothesis {
 public:
  /// No cause: the model as it is.
  explicit CauseHypothesis(const WrenchKnowledge& knowledge) : knowledge_(knowledge) {}
  /// `hand`: of slip and sensor bias. `place`: of CauseResponses, of contact and weight.
  /// kUnknown: the difference of each hand changes as fast as measured.
  CauseHypothesis(Cause cause, int hand, int place, const WrenchKnowledge& knowledge)
      : has_states_(true), cause_(cause), hand_(hand), place_(place), knowledge_(knowledge) {}

  /// Begins with what is known of WrenchStates. `own_compliance`: CauseResponses. `difference`: N,
  /// N m, the discrepancy as reported, for scale.
  void begin(const WrenchKnowledge& before, const Eigen::Vector2d& own_compliance,
             const math::Vector6d& difference) noexcept;
  /// The next record; returns the logarithm of its likelihood, given the records before.
  double take(const CauseRecord& record) noexcept;

  Cause cause() const noexcept { return cause_; }
  int hand() const noexcept { return hand_; }
  int place() const noexcept { return place_; }
  /// Mean of the states of its own.
  math::Vector6d value() const noexcept;
  /// Largest of them, in prior standard deviations.
  double relative_size() const noexcept;
  /// Logarithm of the probability, times 2, that signs are possible: a contact presses, a weight
  /// pulls downward, compliances are positive.
  double log_possible(const CauseRecord& record) const noexcept;
  /// Squared normalised difference per degree of freedom that it leaves, averaged over a second.
  double misfit() const noexcept { return misfit_; }
  /// WrenchStates with its own states added to the offset or bias of the hand: of slip and sensor
  /// bias only.
  WrenchKnowledge absorbed() const noexcept;

 private:
  int state_count() const noexcept;  // of its own
  WrenchKnowledge::Appended rows(int hand, const CauseRecord& record) const noexcept;
  void diffuse(const CauseRecord& record) noexcept;

  bool has_states_ = false;  // of its own
  Cause cause_ = Cause::kUnknown;
  int hand_ = 0, place_ = 0;
  WrenchKnowledge knowledge_;
  WrenchKnowledge::Vector prior_;  // variances of its states
  int records_ = 0;
  double misfit_ = 0;
};

}  // namespace palpate::estimation
