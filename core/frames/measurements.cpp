#include "core/frames/measurements.hpp"

namespace palpate::frames {
namespace {

using sensing::Source;

bool locate_wrist(const ArmMeasurements& arm, sensing::Contact& contact) noexcept {
  if (!arm.known) return false;
  const math::Pose X_OG = arm.X_OE() * arm.frames.X_EG;
  contact.wrench = arm.frames.wrench_in_object(contact.wrench, X_OG.linear());
  contact.location = X_OG.translation();
  return true;
}

bool locate_finger(const ArmMeasurements& arm, sensing::Contact& contact) noexcept {
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
  contact.location = X_OT * contact.location;
  contact.wrench = rotated(X_OT.linear(), contact.wrench);
  return true;
}

}  // namespace

void to_object_frame(const sensing::ContactSet& contacts, const ArmMeasurements& first,
                     const ArmMeasurements& second, sensing::ContactSet& contacts_O) noexcept {
  contacts_O.count = 0;
  for (int i = 0; i < contacts.count; ++i) {
    sensing::Contact& contact = contacts_O.contacts[contacts_O.count];
    contact = contacts.contacts[i];
    const Source source = contact.source;
    const bool located = sensing::is_wrist(source)
                             ? locate_wrist(source == Source::kWrist1 ? second : first, contact)
                         : source == Source::kManual ? true
                                                     : locate_finger(first, contact);
    if (located) ++contacts_O.count;
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
