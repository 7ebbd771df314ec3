#pragma once

#include <array>

#include "core/estimation/consistency/uncertain_touch.hpp"
#include "core/estimation/consistency/wrench_states.hpp"
#include "core/estimation/discrepancy_report.hpp"
#include "core/estimation/fused_state.hpp"

namespace palpate::estimation {

/// Tests whether the wrenches of the hands are consistent with the model. A Kalman filter of its
/// own estimates WrenchStates. Each update compares the mean wrench of 50 ms with what was known
/// 0.5, 1, 2 and 4 s earlier, and with the prior: a sudden discrepancy contradicts recent
/// knowledge, a slowly growing one earlier knowledge, one present from the start the prior. The
/// squared normalised difference of a hand is chi-square distributed with 6 degrees of freedom as
/// long as the model holds; the threshold follows from the permitted rate of false alarms. Unlike
/// WrenchUpdate, whose noise is inflated by information already used because it decides how fast to
/// learn, it uses noise and model error as such. Reference: docs/theory.md, section 4; Willsky and
/// Jones 1976 for tests against earlier knowledge. Nothing allocates.
class WrenchConsistency {
 public:
  /// Standard deviations of what the model does not know in addition to the states of WrenchFilter;
  /// the defaults are those that a careful calibration leaves.
  struct Options {
    double poisson = 0.05;  // 1, of Poisson's ratio
    double density = 0.03;  // 1, relative error of the density
    /// 1, relative error of the stiffness in each direction, compared with the common factor:
    /// uneven stiffness, dimensions
    double stiffness_error = 0.05;
    /// 1, error that varies with the pose of the hand, relative to the size of the wrench
    double pose_error = 0.03;
    double position_error = 3e-4;  // m, error of the hand's position that varies with its pose
    double rotation_error = 1e-3;  // rad, of its rotation
    double false_alarms = 1;       // 1/h, per hand, while the model holds
  };
  static constexpr int kSnapshots = 9;  // one each 0.5 s

  /// A difference between the measured and the predicted wrench of a hand.
  struct Discrepancy {
    double test = -1;  // squared normalised difference per degree of freedom; negative: no test yet
    int hand = 0;
    int axis = 0;  // largest normalised component: force x, y, z, torque x, y, z, in O
    math::Vector6d wrench = math::Vector6d::Zero();  // N, N m, measured minus predicted, in O
  };

  /// `priors`: of the states that the filter estimates too. Throws std::invalid_argument if an
  /// option is out of range.
  WrenchConsistency(const elasticity::Body& body, const WrenchSampling& sampling,
                    const WrenchFilter::Options& priors, const Options& options);

  void reset() noexcept;
  /// Begins with the means and deviations that the filter has of its states.
  void take_over(const WrenchFilter& filter) noexcept;
  /// Takes the innovation of a wrench update. `learn`: whether the wrench may update the knowledge;
  /// false while an external contact is estimated. True if a snapshot was taken now.
  bool take(const Innovation& now, const FusedState& state,
            const elasticity::DeformationModel& model, bool learn) noexcept;

  /// Whether a cause that exists from the start is known, by other means, to explain the wrenches
  /// better than the model: while it is, they count as inconsistent with the prior.
  void suspect(bool is_suspected) noexcept { is_suspected_ = is_suspected; }
  bool is_suspected() const noexcept { return is_suspected_; }

  /// Whether the last take() made a test, of record().
  bool has_tested() const noexcept { return sum_count_ == 0; }
  const WrenchRecord& record() const noexcept { return record_; }
  /// What is known of the states at present; while the wrenches contradict the model, what was
  /// known before.
  const WrenchKnowledge& knowledge() const noexcept { return now_; }

  /// Whether the wrenches contradict the model.
  bool is_inconsistent() const noexcept { return is_inconsistent_; }
  /// Whether that was found by the last take().
  bool has_just_begun() const noexcept { return has_just_begun_; }
  /// Age in snapshots of the last knowledge that is not affected; kSnapshots: the prior.
  int snapshots_back() const noexcept { return snapshots_back_; }
  /// An explanation has been found: continues with this knowledge of the states, without
  /// discrepancy.
  void resume(const WrenchKnowledge& knowledge) noexcept;
  /// Of the last test, the most significant one over hands and ages.
  const Discrepancy& discrepancy() const noexcept { return discrepancy_; }
  /// Writes the results of the last test.
  void write(DiscrepancyReport& report) const noexcept;

 private:
  void linearise(const Innovation& now, const FusedState& state,
                 const elasticity::DeformationModel& model) noexcept;
  WrenchKnowledge::Comparison compare(int hand, const WrenchKnowledge& earlier) const noexcept;
  void judge() noexcept;
  bool is_pending() const noexcept;
  void learn_from_wrenches() noexcept;
  void forget_snapshots() noexcept;

  WrenchStates states_;
  WrenchSampling sampling_;
  std::array<double, 2> lever_{};
  double threshold_;
  UncertainTouch touch_;
  WrenchKnowledge prior_;
  WrenchKnowledge initial_;  // the prior, or what was known at the last resume()
  WrenchKnowledge now_;
  std::array<WrenchKnowledge, kSnapshots> snapshots_;
  int newest_ = 0, snapshot_count_ = 0, updates_ = 0;
  WrenchRecord record_;
  std::array<math::Vector6d, 2> sums_;
  int sum_count_ = 0;
  Discrepancy discrepancy_;
  std::array<math::Vector6d, 2> differences_, deviations_;  // of the last test
  bool is_inconsistent_ = false, has_just_begun_ = false, is_suspected_ = false;
  int snapshots_back_ = 0, exceeded_ = 0, exceeded_prior_ = 0, passed_ = 0;
};

}  // namespace palpate::estimation
