#pragma once

#include <array>
#include <optional>

#include "core/estimation/estimator.hpp"
#include "core/math/rigid.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::frames {

/// Constant transforms of one arm in its workcell, and what follows from them and the pose X_WE of
/// its flange. Frames: W base of that arm, E flange, S force-torque sensor, I IMU, G grasp, O
/// object (the rest frame of its mesh), T fingertip. Wrenches act on the object; m, rad, N, N m.
/// Nothing allocates.
struct ArmFrames {
  math::Pose X_WO = math::Pose::Identity();  // object's rest frame in the robot base
  math::Pose X_ES = math::Pose::Identity();  // pose of the force-torque sensor in the flange
  math::Pose X_EI = math::Pose::Identity();  // pose of the IMU in the flange
  math::Pose X_EG = math::Pose::Identity();  // pose of the grasp in the flange
  Eigen::Vector3d gravity_W{0, 0, -9.81};    // m/s^2
  /// Poses of fingertips that are fixed in O, for a workcell without hand state.
  std::array<std::optional<math::Pose>, 5> X_OT;

  math::Pose X_OE(const math::Pose& X_WE) const noexcept { return X_WO.inverse() * X_WE; }
  math::Pose X_OG(const math::Pose& X_WE) const noexcept { return X_OE(X_WE) * X_EG; }

  math::Pose X_GS() const noexcept { return X_EG.inverse() * X_ES; }

  /// Wrench about the origin of G, in O, from the same wrench about the origin of S, in S. `R_OG`:
  /// rotation of X_OG().
  math::Wrench wrench_in_object(const math::Wrench& F_S,
                                const Eigen::Matrix3d& R_OG) const noexcept;

  /// Velocity of the flange in W from that of the grasp in O. `R_WE`: rotation of X_WE.
  math::Twist flange_twist(const math::Twist& V_O_G, const Eigen::Matrix3d& R_WE) const noexcept;
  /// Velocity of the grasp in O from that of the flange in W; inverse of flange_twist().
  math::Twist grasp_twist(const math::Twist& V_W_E, const Eigen::Matrix3d& R_WE) const noexcept;
};

/// Standard deviations of a wrench about the origin of A, in A, whose deviations about the origin
/// of B are `force`, N, and `torque`, N m, on each axis, all independent.
math::Vector6d transformed_deviation(const math::Pose& X_AB, double force, double torque) noexcept;

/// Covariance (force first) of a wrench about the origin of A, in A, from that about the origin of
/// B, in B.
math::Matrix6d transformed_covariance(const math::Pose& X_AB,
                                      const math::Matrix6d& covariance_B) noexcept;

/// The same wrench in the axes of A instead of B, about the same point.
math::Wrench rotated(const Eigen::Matrix3d& R_AB, const math::Wrench& F_B) noexcept;

/// Whether two poses differ by less than `distance`, m, and `angle`, rad. The angle is measured as
/// |R - R'| / sqrt(2) (Frobenius norm), which equals it where it is small.
bool are_near(const math::Pose& a, const math::Pose& b, double distance, double angle) noexcept;

/// One arm in one tick: its constant frames and its signals. Refers to both.
struct ArmMeasurements {
  const ArmFrames& frames;
  const sensing::Signals& signals;
  bool known = false;  // its robot has reported a pose

  /// Pose of the flange in O, as reported; the identity in W before that.
  math::Pose X_OE() const noexcept { return frames.X_OE(signals.robot.latest.X_WE); }
};

/// Expresses contacts of sensors (see sensing::Contact) in O: the wrench of a wrist at the origin
/// of G, that of a fingertip at its location. Manual contacts are in O already. Contacts whose
/// location is unknown, because the arm or the fingertip is, are left out. Fingertips and the first
/// wrist belong to `first`, the second wrist to `second`.
void to_object_frame(const sensing::ContactSet& contacts, const ArmMeasurements& first,
                     const ArmMeasurements& second, sensing::ContactSet& contacts_O) noexcept;

/// Writes an estimator's input about grasp `index`, the one of wrist `index`. `contacts_O`: of
/// to_object_frame().
void update_grasp(const ArmMeasurements& arm, int index, const sensing::ContactSet& contacts_O,
                  estimation::GraspInput& input) noexcept;

/// Writes the observed points in O. Unless they are new, only freshness and age change.
void update_observation(const ArmMeasurements& arm,
                        estimation::ObservationInput& observation) noexcept;

}  // namespace palpate::frames
