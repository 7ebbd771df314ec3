#pragma once

#include "core/estimation/fused_state.hpp"
#include "core/estimation/rest_baseline.hpp"

namespace palpate::estimation {

/// Update of the fused state by the wrenches at the wrists: predicts the wrench of each hand,
/// delayed as the measured one, accumulates the differences, and weighs them by the noise of the
/// sensor, the model error, which stays the same until the hand has moved, and the errors of a
/// moving hand (docs/theory.md, section 4). Nothing allocates after construction.
class WrenchUpdate {
 public:
  struct Options : WrenchSampling {
    /// Relative model error of the predicted wrench and of the moment of its force about the
    /// object's centre. It stays constant until the hand has moved, regardless of the number of
    /// updates.
    double relative = 0.15;
    double decorrelation_distance = 0.2;  // m, displacement of the hand that decorrelates the error
    double decorrelation_angle = 1;       // rad, rotation of the hand that does
    double correlation = 60;  // s, decorrelation time of the model error while the hand rests
    double lag = 0.01;        // s, delay of the wrench relative to the pose
    /// s, standard deviation of that delay: reduces the weight of wrenches of a moving hand
    double lag_deviation = 0.005;
    /// kg, error of the hand's mass or its delay in the sensor model: reduces the weight of the
    /// wrench while the hand accelerates. One fifth of a hand of 5 kg.
    double payload_error = 1;
  };

  WrenchUpdate(const elasticity::Body& body, const Options& options);

  void reset() noexcept;
  /// The hand no longer holds the object.
  void release(int grasp) noexcept { hands_[grasp] = Hand(); }
  /// Takes the predicted wrench of a hand that holds the object, at G in O, and its measured one.
  /// `X_OG`: pose at which the model holds the grasp.
  void predict(int grasp, const math::Vector6d& wrench, const math::Pose& X_OG,
               const GraspInput& input, double dt) noexcept;
  /// Call once per tick: whether the time of the next update has come.
  bool is_due(double dt) noexcept;

  /// Mean innovation since the last call; empty without a wrench. Also determines the deviations
  /// of the reactions.
  Innovation take_innovation(const FusedState& state,
                             const elasticity::DeformationModel& model) noexcept;
  /// WrenchFilter::test() of an innovation; also reported by innovation_test().
  double test(const Innovation& innovation, FusedState& state) noexcept;
  /// Whether the innovation is below the gate.
  bool passes(const Innovation& innovation, FusedState& state) const noexcept;
  /// Corrects the state by the innovation tested last.
  void correct(const Innovation& innovation, FusedState& state) noexcept;

  /// The state has been corrected by an innovation: the next ones, whose model error is the same,
  /// carry less information.
  void absorb(const Innovation& now) noexcept;
  /// Makes the prediction follow a change of the state at once and reduces the means of the
  /// innovation accordingly, so that no information is used twice. `H`: FusedState::wrench_rows()
  /// of the hands `held`.
  void follow(const std::array<bool, 2>& held, const WrenchFilter::Rows& H,
              WrenchFilter::Vector change, const FusedState& state) noexcept;
  /// The same for a change of the external contact's force by `force_O`, N.
  void follow_contact(const Eigen::Vector3d& force_O, const FusedState& state,
                      const elasticity::DeformationModel& model) noexcept;

  RestBaseline& baseline() noexcept { return baseline_; }
  const RestBaseline& baseline() const noexcept { return baseline_; }
  /// Normalised innovation squared per degree of freedom; negative: none.
  double innovation_test() const noexcept { return innovation_test_; }
  /// Standard deviation of the predicted wrench; negative: not known.
  const math::Vector6d& reaction_deviation(int grasp) const noexcept {
    return hands_[grasp].reaction_deviation;
  }

 private:
  struct Hand {
    /// Predicted wrench, delayed as the measured one.
    math::Vector6d lagged = math::Vector6d::Zero();
    /// Sum of measured minus predicted wrenches since the last update of the filter.
    math::Vector6d sum = math::Vector6d::Zero();
    math::Vector6d sum_measured = math::Vector6d::Zero();  // sum of the measured wrenches
    int count = 0;
    math::Matrix6d covariance = math::Matrix6d::Zero();  // GraspInput::covariance, the latest
    math::Pose X_OG_before = math::Pose::Identity();
    math::Vector6d speed = math::Vector6d::Zero();         // m/s, rad/s, delayed as the wrench
    math::Vector6d acceleration = math::Vector6d::Zero();  // m/s^2, rad/s^2, mean over 50 ms
    math::Vector6d reaction_deviation = math::Vector6d::Constant(-1);
    bool known = false;
    /// Information of the next wrenches: 1 for independent ones, 0 for fully correlated ones.
    double information_gain = 1;
    double travel = 0;  // since the last update, in distances that decorrelate the model error
  };
  /// Fraction of the information that one update absorbs, at most 1.
  double absorbed() const noexcept;
  Eigen::Vector2d inertial_error(const Hand& hand) const noexcept;
  Eigen::Vector2d size_of_wrench(int grasp, const WrenchFilter::Rows& H, const math::Vector6d& y,
                                 const WrenchFilter& filter) const noexcept;
  void add_noise(int grasp, int row, const math::Vector6d& late, const FusedState& state,
                 Innovation& innovation) const noexcept;
  void find_reaction_deviations(const Innovation& innovation, const WrenchFilter& filter) noexcept;

  Options options_;
  std::array<double, 2> lever_{};  // m, from each grasp to the centre of the object, at rest
  std::array<Hand, 2> hands_;
  double since_update_ = 0;  // s
  double innovation_test_ = -1;
  RestBaseline baseline_;
};

}  // namespace palpate::estimation
