// Phases of a tick in order: sense, distribute, estimate, evaluate, control, gate.
#include "rt/pipeline/pipeline.hpp"

#include <utility>

#include "rt/plugin/plugin_guards.hpp"

namespace palpate::pipeline {

void Pipeline::sense(const sensing::Signals& signals, const sensing::Signals& second) noexcept {
  const std::array<const sensing::Signals*, 2> by_arm = {&signals, &second};
  for (int i = 0; i < arm_count(); ++i) {
    arms_[i].signals = by_arm[i];
    arms_[i].known = by_arm[i]->robot.freshness != Freshness::kNoData;
    find_joints(arms_[i]);
  }
  obstacle_condition_.apply(
      obstacles_->update(signals, arms_[0].joints_known, components_->estimate.obstacle_motion));
  obstacle_condition_.component = obstacles_->late();
  contacts_.count = 0;
  for (ComponentSet::Sensing& instance : components_->sensing) {
    const int first = contacts_.count;
    UpdateResult result = instance.model->update(*by_arm[instance.arm], contacts_);
    for (int i = first; i < contacts_.count; ++i) {
      if (registry::is_plausible(contacts_.contacts[i])) continue;
      contacts_.count = first;
      result = {Status::kDegraded, "a contact is not finite or beyond what can be"};
    }
    instance.result = result;
    instance.condition.apply(result);
    if (instance.fallback != nullptr && instance.fallback->in_use() &&
        !std::exchange(instance.fallback_reported, true))
      report_fallback(instance.name.c_str(), "its sensor model has faulted");
    // a model knows only its own arm
    for (int i = first; instance.arm == 1 && i < contacts_.count; ++i) {
      if (sensing::is_wrist(contacts_.contacts[i].source))
        contacts_.contacts[i].source = sensing::Source::kWrist1;
    }
  }
  frames::to_object_frame(contacts_, arms_.front().measurements(), arms_.back().measurements(),
                          contacts_O_);
}

std::optional<WristReport> Pipeline::wrist(int arm) const noexcept {
  const ComponentSet::Sensing* sensor = nullptr;
  for (const ComponentSet::Sensing& instance : components_->sensing)
    if (instance.is_wrist && instance.arm == arm) sensor = &instance;
  if (sensor == nullptr) return {};
  const sensing::Signals& signals = *arms_[arm].signals;
  WristReport report{sensor->result};
  const auto take_time = [&report](const auto& readings) {
    if (readings.freshness == Freshness::kNoData) return;
    report.reading_time = readings.latest.time;
    report.age = readings.age;
  };
  if (sensor->reads_joints) {
    take_time(signals.robot);
  } else {
    take_time(signals.force_torque);
  }
  for (int i = 0; i < contacts_.count; ++i)
    if (sensing::is_wrist(contacts_.contacts[i].source, arm))
      report.contact = &contacts_.contacts[i];
  return report;
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
  arm.joints_known = frames::are_near(arm.kinematics.X_WE, robot.X_WE, kApart, kTurned);
}

void Pipeline::distribute() noexcept {
  if (!has_object()) return;
  for (int i = 0; i < contacts_O_.count; ++i) {
    contact::ContactLoads& loads = components_->loads[i];
    const sensing::Contact& contact = contacts_O_.contacts[i];
    loads.source = contact.source;
    loads.accepted = false;
    loads.loads.clear();
    for (ComponentSet::Contact& instance : components_->contact) {
      if (!instance.sources[static_cast<int>(contact.source)]) continue;
      instance.transformer->distribute(contact, components_->model->positions(), loads);
      loads.source = contact.source;
      check_loads(instance, loads);
      break;
    }
  }
}

void Pipeline::estimate(double dt) noexcept {
  ComponentSet& components = *components_;
  if (!is_running()) return;
  estimation::EstimationInputs& inputs = estimation_inputs_;
  inputs.dt = dt;
  inputs.grasp_count = static_cast<int>(components.object->body.grasps.size());
  for (int i = 0; i < inputs.grasp_count; ++i)
    frames::update_grasp(arms_[i].measurements(), i, contacts_O_, inputs.grasps[i]);
  jaw_condition_.apply(jaws_->update(inputs));
  inputs.contact_count = contacts_O_.count;
  inputs.contacts = components.loads.data();
  frames::update_observation(arms_[0].measurements(), inputs.observation);
  const auto is_sound = [this] {
    place_obstacles();
    ComponentSet& now = *components_;
    UpdateResult result = now.estimator->update(estimation_inputs_, *now.model, now.estimate);
    if (const char* fault = plugin::fault_of(*now.model)) result = {Status::kFault, fault};
    trust_.judge(result, now.estimate, now.on_discrepancy.options(), now.estimation_condition);
    return now.estimation_condition.state != LifeCycle::kFaulted;
  };
  if (!is_sound() &&
      fall_back(fallbacks_->mechanics, "estimation", components.estimation_condition.reason))
    is_sound();
  ComponentSet& now = *components_;
  const bool jumps = now.shape_watch.update(now.model->positions(), dt);
  now.estimate.jumped = jumps || now.estimate.step.restarted;
}

void Pipeline::place_obstacles() noexcept {
  const std::vector<collision::Placement>& placements = obstacles_->placements();
  for (std::size_t i = 0; i < placements.size(); ++i)
    components_->model->place_obstacle(static_cast<int>(i), placements[i]);
}

void Pipeline::evaluate_feature() noexcept {
  if (!is_running()) return;
  update_markers();
  if (!feature_is_sound() && !fallbacks_->steering.in_use &&
      fall_back(fallbacks_->feature, "feature", components_->feature_condition.reason))
    feature_is_sound();
  ComponentSet& components = *components_;
  if (components.feature_condition.state == LifeCycle::kFaulted) {
    components.feature_state.error.setZero();
    components.feature_state.unreachable.setZero();
    return;
  }
  if (components.target.revision >= 0) {
    components.feature->error(components.feature_state.value, components.target.value,
                              components.feature_state.error);
  } else {
    components.feature_state.error.setZero();
    components.feature_state.unreachable.setZero();
  }
}

void Pipeline::control(double dt) noexcept {
  for (Arm& arm : arms_) {
    arm.gate_inputs.requested_W_E = math::Twist();
    arm.requested_joints.setZero();
  }
  if (components_->guarded_motion != nullptr) return move_guarded(dt);
  if (!is_running()) return;
  components_->on_discrepancy.update(trust_.is_in_doubt(), dt);
  if (components_->target.revision < 0 || !moving_arms_known() || !is_trusted()) return;

  const int first = components_->moving == registry::MovingArms::kSecond ? 1 : 0;
  const bool steers =
      steer(dt, first) ||
      (components_->control_condition.state == LifeCycle::kFaulted && !fallbacks_->feature.in_use &&
       fall_back(fallbacks_->steering, "control", components_->control_condition.reason) &&
       steer(dt, first));
  if (!steers) return;
  const double scale = request(first, components_->law_output.V_O_G);
  if (components_->commands_joints)
    arms_[0].requested_joints = scale * components_->law_output.joint_velocity;
  if (components_->moving == registry::MovingArms::kBoth)
    request(1, components_->law_output.V_O_G_second);
}

/// False if the controller provides no command.
bool Pipeline::steer(double dt, int first) noexcept {
  ComponentSet& components = *components_;
  if (components.control_condition.state == LifeCycle::kFaulted) return false;
  if (!components.feature->is_defined()) {
    components.control_condition.apply({Status::kDegraded, "no such feature in this shape"});
    return false;
  }
  if (!observe(dt, first)) return false;
  const math::Pose& X_OG = estimation_inputs_.grasps[first].X_OG;
  const bool knows_jacobian = components.provider->update(*components.feature, *components.model,
                                                          X_OG, components.jacobian);
  control::LawInputs inputs;
  inputs.dt = dt;
  inputs.value = &components.feature_state.value;
  inputs.target = &components.target.value;
  inputs.error = &components.feature_state.error;
  inputs.jacobian = &components.jacobian;
  inputs.model = components.model.get();
  inputs.reaction = components.estimate.reaction;
  inputs.obstacles = &obstacles_->placements();
  inputs.node_deviation = components.estimate.node_deviation;
  for (int i = 0; i < estimation_inputs_.grasp_count; ++i)
    inputs.X_OG[i] = estimation_inputs_.grasps[i].X_OG;
  if (components.provider->commands(inputs, components.law_output.V_O_G)) {
    components.law_output.V_O_G_second = math::Twist();
    const bool finite = components.law_output.V_O_G.vector().allFinite();
    components.control_condition.apply(
        {finite ? Status::kOk : Status::kFault, finite ? "" : "the command is not finite"});
    return finite;
  }
  if (!knows_jacobian) {
    components.control_condition.apply({Status::kDegraded, "no Jacobian yet"});
    return false;
  }
  control::JointInputs joints;
  if (components.commands_joints) {
    if (!arms_[0].joints_known) {
      components.control_condition.apply(
          {Status::kDegraded, "the robot's joints are not those of its model"});
      return false;
    }
    joints = joint_inputs(arms_[0]);
    inputs.joints = &joints;
  }
  components.law->compute(inputs, components.law_output);
  if (!components.law_output.V_O_G.vector().allFinite() ||
      !components.law_output.V_O_G_second.vector().allFinite()) {
    const char* why = components.law_output.remark;
    components.control_condition.apply(
        {Status::kFault, *why == '\0' ? "the command is not finite" : why});
    return false;
  }
  const char* remark = components.law_output.remark;
  components.control_condition.apply({*remark == '\0' ? Status::kOk : Status::kDegraded, remark});
  // if it overflows, the target is far out of reach
  if (components.law_output.unreachable.allFinite()) {
    components.feature_state.unreachable = components.law_output.unreachable;
  } else {
    components.feature_state.unreachable = components.feature_state.error;
  }
  return true;
}

bool Pipeline::moving_arms_known() const noexcept {
  const int grasps = static_cast<int>(components_->object->body.grasps.size());
  const bool second = components_->moving != registry::MovingArms::kFirst;
  if (components_->moving != registry::MovingArms::kSecond && (grasps < 1 || !arms_[0].known))
    return false;
  return !second || (grasps > 1 && arms_[1].known);
}

/// Returns the factor on the command. In doubt it refers to the speed that the gate permits: of a
/// faster command, the gate would restore what the policy takes away.
double Pipeline::request(int index, const math::Twist& V_O_G) noexcept {
  Arm& arm = arms_[index];
  const math::Twist V_W_E = arm.frames.flange_twist(V_O_G, arm.signals->robot.latest.X_WE.linear());
  double scale = components_->on_discrepancy.factor();
  if (scale < 1) {
    const control::GateLimits& limits = cell_.gate[index];
    scale *= control::speed_factor(V_W_E, limits.linear_speed, limits.angular_speed);
  }
  arm.gate_inputs.requested_W_E = {scale * V_W_E.linear, scale * V_W_E.angular};
  return scale;
}

control::JointInputs Pipeline::joint_inputs(const Arm& arm) noexcept {
  control::JointInputs joints;
  const int n = arm.model->chain.joint_count();
  joints.q = arm.signals->robot.latest.q.head(n);
  joints.V_O_G_by_joints.resize(6, n);
  for (int i = 0; i < n; ++i) {
    const math::Twist V_W_E = math::Twist::from(arm.kinematics.J_W_E.col(i));
    joints.V_O_G_by_joints.col(i) =
        arm.frames.grasp_twist(V_W_E, arm.kinematics.X_WE.linear()).vector();
  }
  return joints;
}

/// In the previous tick, while this arm's own gate did not reject its command.
bool Pipeline::other_rejected(int arm) const noexcept {
  return arm_count() > 1 && arms_[1 - arm].output.rejected && !arms_[arm].output.rejected;
}

const control::GateOutput& Pipeline::gate(double dt) noexcept {
  const std::array<bool, 2> held_back = {other_rejected(0), other_rejected(1)};
  for (int i = 0; i < arm_count(); ++i) {
    Arm& arm = arms_[i];
    control::GateInputs& inputs = arm.gate_inputs;
    inputs.dt = dt;
    inputs.active = is_running() && is_trusted() && arm.known && !held_back[i] &&
                    components_->control_condition.state != LifeCycle::kFaulted;
    if (arm.known) inputs.X_WE = arm.signals->robot.latest.X_WE;
    inputs.wrench_valid = false;
    for (int c = 0; c < contacts_.count; ++c) {
      const sensing::Contact& contact = contacts_.contacts[c];
      if (!sensing::is_wrist(contact.source, i)) continue;
      inputs.wrench_valid = true;
      inputs.contact = contact.wrench;
    }
    pass_gate(arm, commands_joints(i));
  }
  return arms_[0].output;
}

void Pipeline::pass_gate(Arm& arm, bool as_joints) noexcept {
  if (!as_joints) {
    if (arm.joint_gate) arm.joint_gate->pass();
    arm.output = arm.gate.apply(arm.gate_inputs);
    return;
  }
  control::JointGateInputs joints;
  joints.requested = arm.requested_joints;
  if (arm.joints_known) {
    joints.q = arm.signals->robot.latest.q.head(arm.model->chain.joint_count());
    joints.J_W_E = arm.kinematics.J_W_E;
  }
  arm.output = arm.joint_gate->apply(joints, arm.gate_inputs, arm.gate);
}

control::DiscrepancyAction Pipeline::discrepancy_action() const noexcept {
  return is_running() && trust_.is_in_doubt() ? components_->on_discrepancy.options().action
                                              : control::DiscrepancyAction::kContinue;
}

Condition Pipeline::condition() const noexcept {
  if (!is_running()) return whole_;
  Condition worst = components_->worst_of(whole_);
  for (const Condition* other : {&obstacle_condition_, &jaw_condition_})
    if (static_cast<int>(other->state) > static_cast<int>(worst.state)) worst = *other;
  return on_fallback() && worst.state == LifeCycle::kActive
             ? Condition{LifeCycle::kDegraded, fallback_reason_.data()}
             : worst;
}

}  // namespace palpate::pipeline
