#pragma once

#include "core/kinematics/chain_dynamics.hpp"
#include "core/sensing/joint_friction.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Contact wrench at the wrist from the torques of the arm's joints, for an arm without a
/// force-torque sensor. A momentum observer (De Luca and Mattone 2005) gives the external torque of
/// each joint, low-pass filtered, without accelerations:
///   r = K (M dq - integral of (tau - friction + C^T dq - g + r) dt).
/// The wrench is the one that fits these torques best, weighted by their deviations. Where the
/// arm's pose makes a direction weak (a small singular value of the Jacobian), its deviation is
/// large, and the wrench tends to zero as it reaches that of the prior, 100 N and 20 N m. A contact
/// with the arm itself is taken for one at the hand.
class JointTorque : public TaredModel<16, SensorState::Offset::kJointTorque> {
 public:
  using Joints = kinematics::SerialChain::Joints;
  struct Options {
    math::Pose X_ES = math::Pose::Identity();  // frame of the wrench in the flange
    /// The readings are external torques already: no dynamics and no friction are subtracted.
    bool external = false;
    /// 1: the torque of the drive on the link, and J^T F for the wrench F of the surroundings on
    /// the hand if external; -1: the opposite.
    double polarity = 1;
    double bandwidth = 10;  // Hz, of the observer: K / 2 pi
    JointFriction::Options friction;
    /// N m, per joint, standard deviation of the external torque without friction: noise, and what
    /// neither friction nor `model_error` explains.
    Joints deviation;
    /// Relative standard deviation of the model's weight and Coriolis torque, counted from the
    /// pose of the last tare, whose error the tare has removed.
    double model_error = 0.01;
    int tare_samples = 500;
    bool tare_at_start = false;
    double max_age = 0.025;  // s, maximum age of the latest joint torques
    Source source = Source::kWrist0;
  };

  /// Throws std::invalid_argument naming the invalid option.
  JointTorque(const kinematics::ChainDynamics& dynamics, const Options& options);

  /// A tare waits until friction is known (JointFriction::is_known).
  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void reset() noexcept override;

  /// External torque of each joint without the offset, of the surroundings on the arm, and its
  /// standard deviation, N m.
  const Joints& external_torque() const noexcept { return external_; }
  const Joints& deviation() const noexcept { return deviation_; }

 private:
  enum class Reading { kUsable, kWrongCount, kNotFinite, kAbsent };
  Reading read(const RobotState& state) const noexcept;
  void take(const RobotState& state) noexcept;
  Contact contact() const noexcept;

  kinematics::ChainDynamics dynamics_;
  Options options_;
  JointFriction friction_;
  kinematics::ChainDynamics::State state_, before_;
  kinematics::SerialChain::State place_;
  Joints q_, driving_, driving_before_;  // driving: torque that changes the momentum, without r
  double time_ = 0;                      // s, of the last usable reading, sender's clock
  bool has_reading_ = false;
  double unusable_for_ = 0;  // s, since the last usable reading while others arrive
  Reading unusable_ = Reading::kUsable;
  Joints residual_, external_, deviation_;
  Joints tared_load_;  // N m, modelled torque at the end of the last tare
};

}  // namespace palpate::sensing
