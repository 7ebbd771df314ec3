#pragma once

#include <array>

#include "core/estimation/fused_state.hpp"
#include "core/estimation/wrench_innovation.hpp"

namespace palpate::estimation {

/// Tests whether the wrenches of the hands are consistent with the model. A Kalman filter of its
/// own estimates offsets of the grasps, biases of the sensors, stiffness, Poisson's ratio and
/// density and, for each hand, an error of the predicted wrench that decorrelates as the hand
/// moves. Each update compares the mean wrench of 50 ms with what was known 0.5, 1, 2 and 4 s
/// earlier, and with the prior: a sudden discrepancy contradicts recent knowledge, a slowly growing
/// one earlier knowledge, one present from the start the prior. The squared normalised difference
/// of a hand is chi-square distributed with 6 degrees of freedom as long as the model holds; the
/// threshold follows from the permitted rate of false alarms. Unlike WrenchUpdate, whose noise is
/// inflated by information already used because it decides how fast to learn, it uses noise and
/// model error as such. Reference: docs/theory.md, section 4; Willsky and Jones 1976 for tests
/// against earlier knowledge. Nothing allocates.
class WrenchConsistency {
 public:
  /// Standard deviations of what the model does not know in addition to the states of WrenchFilter;
  /// the defaults are those that a careful calibration leaves.
  struct Options {
    double dimensions = 0.005;  // 1, relative error of the object's dimensions
    double poisson = 0.05;      // 1, of Poisson's ratio
    double density = 0.03;      // 1, relative error of the density
    /// 1, relative error of the predicted wrench that varies with the pose of the hand: uneven
    /// stiffness, discretisation
    double pose_error = 0.06;
    double false_alarms = 1;  // 1/h, per hand, while the model holds
  };
  static constexpr int kSnapshots = 9;  // one each 0.5 s

  /// A difference between the measured and the predicted wrench of a hand.
  struct Discrepancy {
    double test = -1;  // squared normalised difference per degree of freedom; negative: no test yet
    int hand = 0;
    int axis = 0;  // largest normalised component: force x, y, z, torque x, y, z, in O
    /// Components over their standard deviations.
    math::Vector6d normalised = math::Vector6d::Zero();
    math::Vector6d wrench = math::Vector6d::Zero();  // N, N m, measured minus predicted, in O
  };

  /// `priors`: of the states that the filter estimates too. Throws std::invalid_argument if an
  /// option is out of range.
  WrenchConsistency(const elasticity::Body& body, const WrenchSampling& sampling,
                    const WrenchFilter::Options& priors, const Options& options);

  void reset() noexcept;
  /// Takes the innovation of a wrench update. `learn`: whether the wrench may update the knowledge;
  /// false while an external contact is estimated. True if a snapshot was taken now.
  bool take(const Innovation& now, const FusedState& state,
            const elasticity::DeformationModel& model, bool learn) noexcept;

  /// Whether the wrenches contradict the model.
  bool is_inconsistent() const noexcept { return is_inconsistent_; }
  /// Whether that was found by the last take().
  bool has_just_begun() const noexcept { return has_just_begun_; }
  /// Age in snapshots of the last knowledge that is not affected; kSnapshots: the prior.
  int snapshots_back() const noexcept { return snapshots_back_; }
  /// Of the last update, the most significant one over hands and ages.
  const Discrepancy& discrepancy() const noexcept { return discrepancy_; }
  /// Threshold of Discrepancy::test.
  double threshold() const noexcept { return threshold_; }

 private:
  static constexpr int kMostStates = 39;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostStates, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostStates, kMostStates>;
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostStates>;
  /// Mean and covariance of the states, and the distance travelled by each hand until then, in
  /// decorrelation lengths.
  struct Knowledge {
    Vector mean;
    Matrix covariance;
    std::array<double, 2> travel{};
  };
  /// Mean wrench difference of one hand since the last update, linearised.
  struct HandData {
    bool valid = false;
    Rows H;            // by state
    math::Vector6d y;  // measured minus predicted for the nominal parameters
    math::Matrix6d R;
    math::Vector6d error;  // N, N m, standard deviation of the error that varies with the pose
  };

  int bias(int grasp) const noexcept { return 6 * grasps_ + 6 * grasp; }
  int material() const noexcept { return 12 * grasps_; }
  int error(int grasp) const noexcept { return material() + 3 + 6 * grasp; }

  void linearise(const Innovation& now, const FusedState& state,
                 const elasticity::DeformationModel& model) noexcept;
  Knowledge at_present(const Knowledge& earlier) const noexcept;
  Discrepancy compare(int hand, const Knowledge& earlier) const noexcept;
  void judge() noexcept;
  void learn_from_wrenches() noexcept;

  int grasps_;
  WrenchSampling sampling_;
  Options options_;
  std::array<double, 2> lever_{};
  double threshold_;
  Knowledge prior_, now_;
  std::array<Knowledge, kSnapshots> snapshots_;
  int newest_ = 0, snapshot_count_ = 0, updates_ = 0;
  std::array<HandData, 2> hands_;
  std::array<math::Vector6d, 2> sums_;
  int sum_count_ = 0;
  std::array<double, 2> travel_{};
  Discrepancy discrepancy_;
  bool is_inconsistent_ = false, has_just_begun_ = false;
  int snapshots_back_ = 0, exceeded_ = 0, passed_ = 0;
};

}  // namespace palpate::estimation
