#include "core/frames/arm_frames.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::frames {
namespace {

using sensing::Source;

/// Writes location and wrench of `contact` in O; false if the contact's location is unknown.
bool locate_wrist(const ArmMeasurements& arm, const sensing::Contact& contact,
                  sensing::Contact& contact_O) noexcept {
  if (!arm.known) return false;
  const math::Pose X_OG = arm.X_OE() * arm.frames.X_EG;
  contact_O.wrench = arm.frames.wrench_in_object(contact.wrench, X_OG.linear());
  contact_O.covariance = transformed_covariance(
      math::make_pose(X_OG.linear(), Eigen::Vector3d::Zero()) * arm.frames.X_GS(),
      contact.covariance);
  contact_O.location = X_OG.translation();
  return true;
}

bool locate_finger(const ArmMeasurements& arm, const sensing::Contact& contact,
                   sensing::Contact& contact_O) noexcept {
  const int finger = static_cast<int>(contact.source) - static_cast<int>(Source::kFinger0);
  const sensing::Stream<sensing::HandState, 4>& hand = arm.signals.hand;
  math::Pose X_OT;
  if (arm.frames.X_OT[finger]) {
    X_OT = *arm.frames.X_OT[finger];
  } else if (arm.known && hand.freshness != Freshness::kNoData &&
             finger < hand.latest.fingertip_count) {
    X_OT = arm.X_OE() * hand.latest.X_ET[finger];
  } else {
    return false;
  }
  contact_O.location = X_OT * contact.location;
  contact_O.wrench = rotated(X_OT.linear(), contact.wrench);
  return true;
}

bool locate(const sensing::Contact& contact, const ArmMeasurements& first,
            const ArmMeasurements& second, sensing::Contact& contact_O) noexcept {
  if (sensing::is_wrist(contact.source))
    return locate_wrist(contact.source == Source::kWrist1 ? second : first, contact, contact_O);
  if (contact.source != Source::kManual) return locate_finger(first, contact, contact_O);
  contact_O.location = contact.location;
  contact_O.wrench = contact.wrench;
  return true;
}

}  // namespace

math::Wrench ArmFrames::wrench_in_object(const math::Wrench& F_S,
                                         const Eigen::Matrix3d& R_OG) const noexcept {
  return rotated(R_OG, math::transform(X_GS(), F_S));
}

math::Twist ArmFrames::flange_twist(const math::Twist& V_O_G,
                                    const Eigen::Matrix3d& R_WE) const noexcept {
  const Eigen::Matrix3d& R_WO = X_WO.linear();
  const math::Twist V_W_G{R_WO * V_O_G.linear, R_WO * V_O_G.angular};
  const Eigen::Vector3d p_G_E_W = -(R_WE * X_EG.translation());
  return math::move_reference(V_W_G, p_G_E_W);
}

math::Twist ArmFrames::grasp_twist(const math::Twist& V_W_E,
                                   const Eigen::Matrix3d& R_WE) const noexcept {
  const Eigen::Vector3d p_E_G_W = R_WE * X_EG.translation();
  const Eigen::Matrix3d R_OW = X_WO.linear().transpose();
  return {R_OW * (V_W_E.linear + V_W_E.angular.cross(p_E_G_W)), R_OW * V_W_E.angular};
}

math::Vector6d transformed_deviation(const math::Pose& X_AB, double force, double torque) noexcept {
  const Eigen::Vector3d p = X_AB.translation();
  math::Vector6d deviation;
  deviation.head<3>().setConstant(force);
  // of torque + p x force: the lever of each axis is the distance of B's origin from it
  for (int axis = 0; axis < 3; ++axis)
    deviation[3 + axis] =
        std::sqrt(torque * torque + force * force * (p.squaredNorm() - p[axis] * p[axis]));
  return deviation;
}

math::Matrix6d transformed_covariance(const math::Pose& X_AB,
                                      const math::Matrix6d& covariance_B) noexcept {
  math::Matrix6d transform = math::both_halves(X_AB.linear());
  transform.bottomLeftCorner<3, 3>() = math::cross_matrix(X_AB.translation()) * X_AB.linear();
  math::Matrix6d half;
  half.noalias() = transform * covariance_B;
  return half * transform.transpose();
}

math::Wrench rotated(const Eigen::Matrix3d& R_AB, const math::Wrench& F_B) noexcept {
  return {R_AB * F_B.force, R_AB * F_B.torque};
}

bool are_near(const math::Pose& a, const math::Pose& b, double distance, double angle) noexcept {
  const double turned = std::sqrt(std::max(0.0, 3 - a.linear().cwiseProduct(b.linear()).sum()));
  return (a.translation() - b.translation()).norm() < distance && turned < angle;
}

void to_object_frame(const sensing::ContactSet& contacts, const ArmMeasurements& first,
                     const ArmMeasurements& second, sensing::ContactSet& contacts_O) noexcept {
  contacts_O.count = 0;
  for (int i = 0; i < contacts.count; ++i) {
    const sensing::Contact& contact = contacts.contacts[i];
    sensing::Contact& contact_O = contacts_O.contacts[contacts_O.count];
    contact_O.covariance.setZero();
    if (!locate(contact, first, second, contact_O)) continue;
    contact_O.source = contact.source;
    contact_O.force_deviation = contact.force_deviation;
    ++contacts_O.count;
  }
}

void update_grasp(const ArmMeasurements& arm, int index, const sensing::ContactSet& contacts_O,
                  estimation::GraspInput& input) noexcept {
  input.pose_freshness = arm.signals.robot.freshness;
  input.X_OG = arm.X_OE() * arm.frames.X_EG;
  // Without a hand that reports its grasp, an arm that reports its pose counts as holding.
  const sensing::Stream<sensing::HandState, 4>& hand = arm.signals.hand;
  const bool hand_known = hand.freshness != Freshness::kNoData;
  input.holding = arm.known && (!hand_known || hand.latest.grasp != sensing::Grasp::kNone);
  input.wrench_valid = false;
  input.F_G_O = math::Wrench();
  for (int i = 0; i < contacts_O.count; ++i) {
    const sensing::Contact& contact = contacts_O.contacts[i];
    if (!sensing::is_wrist(contact.source, index)) continue;
    input.wrench_valid = true;
    input.F_G_O = contact.wrench;
    input.covariance = contact.covariance;
  }
}

void update_observation(const ArmMeasurements& arm,
                        estimation::ObservationInput& observation) noexcept {
  const sensing::Stream<sensing::ShapeObservation, 1>& stream = arm.signals.observation;
  observation.freshness = stream.freshness;
  observation.age = stream.age;
  if (stream.freshness != Freshness::kNew) return;
  const sensing::ShapeObservation& seen = stream.latest;
  const math::Pose X_OW = arm.frames.X_WO.inverse();
  observation.time = seen.time;
  observation.deviation = seen.deviation;
  observation.points_O.resize(3, seen.count);
  for (int i = 0; i < seen.count; ++i)
    observation.points_O.col(i) = X_OW * seen.points_W.col(i).cast<double>();
}

}  // namespace palpate::frames
