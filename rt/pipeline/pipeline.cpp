// Phases of a tick in order: sense, distribute, estimate, evaluate, control, gate.
#include "rt/pipeline/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rt/plugin/plugin_guards.hpp"

namespace palpate::pipeline {
namespace {

using sensing::Source;

bool is_wrist(Source source) { return source == Source::kWrist0 || source == Source::kWrist1; }
int wrist(Source source) { return source == Source::kWrist1 ? 1 : 0; }

}  // namespace

void Pipeline::sense(const sensing::Signals& signals, const sensing::Signals& second) noexcept {
  const std::array<const sensing::Signals*, 2> by_arm = {&signals, &second};
  for (int i = 0; i < arm_count(); ++i) {
    arms_[i].signals = by_arm[i];
    arms_[i].known = by_arm[i]->robot.freshness != sensing::Freshness::kNoData;
    find_joints(arms_[i]);
  }
  contacts_.count = 0;
  for (Slots::Sensing& instance : slots_->sensing) {
    const int first = contacts_.count;
    sensing::UpdateResult result = instance.model->update(*by_arm[instance.arm], contacts_);
    for (int i = first; i < contacts_.count; ++i) {
      if (registry::is_plausible(contacts_.contacts[i])) continue;
      contacts_.count = first;
      result = {sensing::Status::kDegraded, "a contact is not finite or beyond what can be"};
    }
    instance.condition.apply(result);
    if (instance.fallback != nullptr && instance.fallback->in_use() &&
        !std::exchange(instance.told, true))
      tell_fallback(instance.name.c_str(), "its sensor model has faulted");
    // a model knows only its own arm
    for (int i = first; instance.arm == 1 && i < contacts_.count; ++i) {
      if (is_wrist(contacts_.contacts[i].source)) contacts_.contacts[i].source = Source::kWrist1;
    }
  }
  to_object_frame(contacts_);
}

void Pipeline::find_joints(Arm& arm) noexcept {
  // m, rad: larger deviations indicate another arm or flange
  constexpr double kApart = 0.02, kTurned = 0.1;
  if (!arm.model) return;
  const sensing::RobotState& robot = arm.signals->robot.latest;
  const int n = arm.model->chain.joint_count();
  arm.joints_known = arm.known && robot.joint_count == n;
  if (!arm.joints_known) return;
  arm.model->chain.evaluate(robot.q.head(n), arm.kinematics);
  const math::Pose& X_WE = arm.kinematics.X_WE;
  const double turned = std::sqrt(std::max(
      0.0, 3 - X_WE.linear().cwiseProduct(robot.X_WE.linear()).sum()));  // |R - R'| / sqrt 2
  arm.joints_known =
      (X_WE.translation() - robot.X_WE.translation()).norm() < kApart && turned < kTurned;
}

void Pipeline::to_object_frame(const sensing::ContactSet& contacts) noexcept {
  contacts_O_.count = 0;
  for (int i = 0; i < contacts.count; ++i) {
    sensing::Contact contact = contacts.contacts[i];
    const bool located = is_wrist(contact.source)            ? locate_wrist(contact)
                         : contact.source == Source::kManual ? true
                                                             : locate_finger(contact);
    if (located) contacts_O_.push(contact);
  }
}

/// False if its location is unknown.
bool Pipeline::locate_wrist(sensing::Contact& contact) const noexcept {
  const Arm& arm = arms_[wrist(contact.source)];
  if (!arm.known) return false;
  const math::Pose X_OG = arm.X_OE() * arm.frames.X_EG;
  const math::Pose X_GS = arm.frames.X_EG.inverse() * arm.frames.X_ES;
  const math::Wrench F_G = math::transform(X_GS, contact.wrench);
  contact.wrench = {X_OG.linear() * F_G.force, X_OG.linear() * F_G.torque};
  contact.location = X_OG.translation();
  return true;
}

bool Pipeline::locate_finger(sensing::Contact& contact) const noexcept {
  const int finger = static_cast<int>(contact.source) - static_cast<int>(Source::kFinger0);
  const Arm& arm = arms_[0];
  const sensing::Stream<sensing::HandState, 4>& hand = arm.signals->hand;
  math::Pose X_OT;
  if (arm.frames.X_OT[finger]) {
    X_OT = *arm.frames.X_OT[finger];
  } else if (arm.known && hand.freshness != sensing::Freshness::kNoData &&
             finger < hand.latest.fingertip_count) {
    X_OT = arm.X_OE() * hand.latest.X_ET[finger];
  } else {
    return false;
  }
  contact.location = X_OT * contact.location;
  contact.wrench = {X_OT.linear() * contact.wrench.force, X_OT.linear() * contact.wrench.torque};
  return true;
}

void Pipeline::distribute() noexcept {
  for (int i = 0; i < contacts_O_.count; ++i) {
    contact::ContactLoads& loads = slots_->loads[i];
    const sensing::Contact& contact = contacts_O_.contacts[i];
    loads.source = contact.source;
    loads.accepted = false;
    loads.loads.clear();
    for (Slots::Contact& instance : slots_->contact) {
      if (!instance.sources[static_cast<int>(contact.source)]) continue;
      instance.transformer->distribute(contact, slots_->model->positions(), loads);
      loads.source = contact.source;
      check_loads(instance, loads);
      break;
    }
  }
}

estimation::GraspInput Pipeline::grasp_input(int grasp) const noexcept {
  const Arm& arm = arms_[grasp];
  estimation::GraspInput input;
  input.pose_freshness = arm.signals->robot.freshness;
  input.X_OG = arm.X_OE() * arm.frames.X_EG;
  // Without a hand that reports its grasp, an arm that reports its pose counts as holding.
  const sensing::Stream<sensing::HandState, 4>& hand = arm.signals->hand;
  const bool hand_known = hand.freshness != sensing::Freshness::kNoData;
  input.holding = arm.known && (!hand_known || hand.latest.grasp != sensing::Grasp::kNone);
  for (int i = 0; i < contacts_O_.count; ++i) {
    const sensing::Contact& contact = contacts_O_.contacts[i];
    if (!is_wrist(contact.source) || wrist(contact.source) != grasp) continue;
    input.wrench_valid = true;
    input.F_G_O = contact.wrench;
  }
  return input;
}

void Pipeline::take_observation(estimation::ObservationInput& input) const noexcept {
  const sensing::Stream<sensing::ShapeObservation, 1>& stream = arms_[0].signals->observation;
  input.freshness = stream.freshness;
  input.age = stream.age;
  if (stream.freshness != sensing::Freshness::kNew) return;
  const sensing::ShapeObservation& seen = stream.latest;
  const math::Pose X_OW = arms_[0].frames.X_WO.inverse();
  input.time = seen.time;
  input.deviation = seen.deviation;
  input.points_O.resize(3, seen.count);
  for (int i = 0; i < seen.count; ++i)
    input.points_O.col(i) = X_OW * seen.points_W.col(i).cast<double>();
}

void Pipeline::estimate(double dt) noexcept {
  Slots& slots = *slots_;
  if (!is_running()) return;
  estimation::EstimationInputs& inputs = estimation_inputs_;
  inputs.dt = dt;
  inputs.grasp_count = static_cast<int>(slots.object->body.grasps.size());
  for (int i = 0; i < inputs.grasp_count; ++i) inputs.grasps[i] = grasp_input(i);
  inputs.contact_count = contacts_O_.count;
  inputs.contacts = slots.loads.data();
  take_observation(inputs.observation);
  const auto is_sound = [this] {
    Slots& now = *slots_;
    sensing::UpdateResult result =
        now.estimator->update(estimation_inputs_, *now.model, now.estimate);
    if (const char* fault = plugin::fault_of(*now.model)) result = {sensing::Status::kFault, fault};
    now.estimation_condition.apply(result);
    return now.estimation_condition.state != LifeCycle::kFaulted;
  };
  if (!is_sound() &&
      fall_back(fallbacks_->mechanics, "estimation", slots.estimation_condition.reason))
    is_sound();
  Slots& now = *slots_;
  const bool jumps = now.jump.update(now.model->positions(), dt);
  now.estimate.jumped = jumps || now.estimate.step.restarted;
}

void Pipeline::evaluate_feature() noexcept {
  if (!is_running()) return;
  look_at_markers();
  if (!feature_is_sound() && !fallbacks_->steering.in_use &&
      fall_back(fallbacks_->feature, "feature", slots_->feature_condition.reason))
    feature_is_sound();
  Slots& slots = *slots_;
  if (slots.feature_condition.state == LifeCycle::kFaulted) {
    slots.feature_state.error.setZero();
    slots.feature_state.unreachable.setZero();
    return;
  }
  if (slots.target.revision >= 0) {
    slots.feature->error(slots.feature_state.value, slots.target.value, slots.feature_state.error);
  } else {
    slots.feature_state.error.setZero();
    slots.feature_state.unreachable.setZero();
  }
}

void Pipeline::control(double dt) noexcept {
  for (Arm& arm : arms_) {
    arm.requested_W_E = math::Twist();
    arm.requested_joints.setZero();
  }
  if (!is_running() || slots_->target.revision < 0 || !moving_arms_known()) return;
  if (!is_trusted()) return;

  const int first = slots_->moving == registry::MovingArms::kSecond ? 1 : 0;
  const bool steers =
      steer(dt, first) ||
      (slots_->control_condition.state == LifeCycle::kFaulted && !fallbacks_->feature.in_use &&
       fall_back(fallbacks_->steering, "control", slots_->control_condition.reason) &&
       steer(dt, first));
  if (!steers) return;
  request(first, slots_->law_output.V_O_G);
  if (slots_->commands_joints) arms_[0].requested_joints = slots_->law_output.joint_velocity;
  if (slots_->moving == registry::MovingArms::kBoth) request(1, slots_->law_output.V_O_G_second);
}

/// False if the controller provides no command.
bool Pipeline::steer(double dt, int first) noexcept {
  Slots& slots = *slots_;
  if (slots.control_condition.state == LifeCycle::kFaulted) return false;
  if (!slots.feature->is_defined()) {
    slots.control_condition.apply({sensing::Status::kDegraded, "no such feature in this shape"});
    return false;
  }
  if (!look_and_learn(dt, first)) return false;
  const math::Pose& X_OG = estimation_inputs_.grasps[first].X_OG;
  const bool knows_jacobian =
      slots.provider->update(*slots.feature, *slots.model, X_OG, slots.jacobian);
  control::LawInputs inputs;
  inputs.dt = dt;
  inputs.value = &slots.feature_state.value;
  inputs.target = &slots.target.value;
  inputs.error = &slots.feature_state.error;
  inputs.jacobian = &slots.jacobian;
  inputs.model = slots.model.get();
  inputs.reaction = slots.estimate.reaction;
  inputs.node_deviation = slots.estimate.node_deviation;
  for (int i = 0; i < estimation_inputs_.grasp_count; ++i)
    inputs.X_OG[i] = estimation_inputs_.grasps[i].X_OG;
  if (slots.provider->commands(inputs, slots.law_output.V_O_G)) {
    slots.law_output.V_O_G_second = math::Twist();
    const bool finite = slots.law_output.V_O_G.vector().allFinite();
    slots.control_condition.apply({finite ? sensing::Status::kOk : sensing::Status::kFault,
                                   finite ? "" : "the command is not finite"});
    return finite;
  }
  if (!knows_jacobian) {
    slots.control_condition.apply({sensing::Status::kDegraded, "no Jacobian yet"});
    return false;
  }
  control::JointInputs joints;
  if (slots.commands_joints) {
    if (!arms_[0].joints_known) {
      slots.control_condition.apply(
          {sensing::Status::kDegraded, "the robot's joints are not those of its model"});
      return false;
    }
    joints = joint_inputs(arms_[0]);
    inputs.joints = &joints;
  }
  slots.law->compute(inputs, slots.law_output);
  if (!slots.law_output.V_O_G.vector().allFinite() ||
      !slots.law_output.V_O_G_second.vector().allFinite()) {
    const char* why = slots.law_output.remark;
    slots.control_condition.apply(
        {sensing::Status::kFault, *why == '\0' ? "the command is not finite" : why});
    return false;
  }
  const char* remark = slots.law_output.remark;
  slots.control_condition.apply(
      {*remark == '\0' ? sensing::Status::kOk : sensing::Status::kDegraded, remark});
  // if it overflows, the target is far out of reach
  if (slots.law_output.unreachable.allFinite()) {
    slots.feature_state.unreachable = slots.law_output.unreachable;
  } else {
    slots.feature_state.unreachable = slots.feature_state.error;
  }
  return true;
}

/// The robot must not move with an unreliable shape estimate, nor with a hand without valid force
/// measurement.
bool Pipeline::is_trusted() const noexcept {
  for (const Slots::Sensing& instance : slots_->sensing) {
    if (instance.condition.state != LifeCycle::kActive) return false;
  }
  for (const Slots::Contact& instance : slots_->contact) {
    if (instance.condition.state == LifeCycle::kFaulted) return false;
  }
  return slots_->estimation_condition.state == LifeCycle::kActive &&
         slots_->feature_condition.state != LifeCycle::kFaulted;
}

bool Pipeline::moving_arms_known() const noexcept {
  const int grasps = static_cast<int>(slots_->object->body.grasps.size());
  const bool second = slots_->moving != registry::MovingArms::kFirst;
  if (slots_->moving != registry::MovingArms::kSecond && (grasps < 1 || !arms_[0].known))
    return false;
  return !second || (grasps > 1 && arms_[1].known);
}

void Pipeline::request(int index, const math::Twist& V_O_G) noexcept {
  Arm& arm = arms_[index];
  const Eigen::Matrix3d& R_WO = arm.frames.X_WO.linear();
  const math::Twist V_W_G{R_WO * V_O_G.linear, R_WO * V_O_G.angular};
  const Eigen::Vector3d p_G_E_W =
      -(arm.signals->robot.latest.X_WE.linear() * arm.frames.X_EG.translation());
  arm.requested_W_E = math::move_reference(V_W_G, p_G_E_W);
}

control::JointInputs Pipeline::joint_inputs(const Arm& arm) const noexcept {
  control::JointInputs joints;
  const int n = arm.model->chain.joint_count();
  joints.q = arm.signals->robot.latest.q.head(n);
  const Eigen::Vector3d p_E_G_W = arm.kinematics.X_WE.linear() * arm.frames.X_EG.translation();
  const Eigen::Matrix3d R_OW = arm.frames.X_WO.linear().transpose();
  joints.V_O_G_by_joints.resize(6, n);
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d v = arm.kinematics.J_W_E.col(i).head<3>();
    const Eigen::Vector3d w = arm.kinematics.J_W_E.col(i).tail<3>();
    joints.V_O_G_by_joints.col(i) << R_OW * (v + w.cross(p_E_G_W)), R_OW * w;
  }
  return joints;
}

/// In the previous tick, while this arm's own gate did not reject its command.
bool Pipeline::other_refused(int arm) const noexcept {
  return arm_count() > 1 && arms_[1 - arm].output.refused && !arms_[arm].output.refused;
}

const control::GateOutput& Pipeline::gate(double dt) noexcept {
  const std::array<bool, 2> held_back = {other_refused(0), other_refused(1)};
  for (int i = 0; i < arm_count(); ++i) {
    Arm& arm = arms_[i];
    control::GateInputs inputs;
    inputs.dt = dt;
    inputs.active = is_running() && is_trusted() && arm.known && !held_back[i] &&
                    slots_->control_condition.state != LifeCycle::kFaulted;
    inputs.requested_W_E = arm.requested_W_E;
    if (arm.known) inputs.X_WE = arm.signals->robot.latest.X_WE;
    for (int c = 0; c < contacts_.count; ++c) {
      const sensing::Contact& contact = contacts_.contacts[c];
      if (!is_wrist(contact.source) || wrist(contact.source) != i) continue;
      inputs.wrench_valid = true;
      inputs.contact = contact.wrench;
    }
    pass_gate(arm, inputs, commands_joints(i));
  }
  return arms_[0].output;
}

void Pipeline::pass_gate(Arm& arm, const control::GateInputs& inputs, bool as_joints) noexcept {
  if (!as_joints) {
    if (arm.joint_gate) arm.joint_gate->pass();
    arm.output = arm.gate.apply(inputs);
    return;
  }
  control::JointGateInputs joints;
  joints.requested = arm.requested_joints;
  if (arm.joints_known) {
    joints.q = arm.signals->robot.latest.q.head(arm.model->chain.joint_count());
    joints.J_W_E = arm.kinematics.J_W_E;
  }
  arm.output = arm.joint_gate->apply(joints, inputs, arm.gate);
}

Condition Pipeline::condition() const noexcept {
  if (!is_running()) return whole_;
  const Condition worst = slots_->worst_of(whole_);
  return on_fallback() && worst.state == LifeCycle::kActive
             ? Condition{LifeCycle::kDegraded, fallback_reason_.data()}
             : worst;
}

}  // namespace palpate::pipeline
