#pragma once

#include "core/estimation/estimator.hpp"
#include "core/frames/arm_frames.hpp"

namespace palpate::frames {

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
