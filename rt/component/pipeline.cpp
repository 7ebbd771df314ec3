#include "rt/component/pipeline.hpp"

#include <cstring>

namespace palpate::component {
namespace {

using sensing::Source;

bool is_wrist(Source source) { return source == Source::kWrist0 || source == Source::kWrist1; }
int wrist(Source source) { return source == Source::kWrist1 ? 1 : 0; }

/// Which sources a contact instance serves, by the words of its list `sources`.
std::array<bool, 8> read_sources(const config::Node& node) {
  std::array<bool, 8> served{};
  const std::string text =
      node.choice("sources", {"wrist", "second_wrist", "fingers", "manual", "all"}, "all");
  const bool all = text == "all";
  if (all || text == "wrist") served[0] = true;
  if (all || text == "second_wrist") served[1] = true;
  if (all || text == "fingers") std::fill(served.begin() + 2, served.begin() + 7, true);
  if (all || text == "manual") served[7] = true;
  return served;
}

}  // namespace

Pipeline::Pipeline(const config::Node& root, double period, bool deterministic) {
  build_arms(root);
  context_.period = period;
  context_.deterministic = deterministic;
  context_.inference = read_inference(root, deterministic);
  context_.remarks = &remarks_;
  object_ = read_object(root, context_.frames);
  context_.object = &object_;

  build_sensing(root);
  build_contact(root);
  model_ = make_deformation_model(root.child("deformation"), context_);
  estimator_ = make_estimator(root.child("estimation"), context_);
  feature_ = make_feature(root.child("feature"), context_);
  provider_ = make_jacobian_provider(root.child("control"), context_);
  law_ = make_control_law(root.child("control"), context_, *feature_);
  moving_ = read_moving_arms(root.child("control"), context_);

  const int dimension = feature_->dimension();
  feature_state_.value = Eigen::VectorXd::Zero(feature_->value_count());
  feature_state_.error = Eigen::VectorXd::Zero(dimension);
  feature_state_.unreachable = Eigen::VectorXd::Zero(dimension);
  target_.value = Eigen::VectorXd::Zero(feature_->value_count());
  jacobian_ = Eigen::MatrixXd::Zero(dimension, moving_ == MovingArms::kBoth ? 12 : 6);
  law_output_.unreachable = Eigen::VectorXd::Zero(dimension);
  warm_up();
  whole_ = {LifeCycle::kInactive, "waits for start"};
}

Pipeline::~Pipeline() = default;

void Pipeline::build_arms(const config::Node& root) {
  context_.frames = read_frames(root);
  context_.second_frames = read_second_frames(root);
  const control::GateLimits limits = read_gate_limits(root);
  arms_.push_back({context_.frames, control::SafetyGate(limits), nullptr, false, {}, {}});
  if (!context_.second_frames) return;
  const control::GateLimits second = read_gate_limits(root.child("second_arm"), limits);
  arms_.push_back({*context_.second_frames, control::SafetyGate(second), nullptr, false, {}, {}});
}

void Pipeline::build_sensing(const config::Node& root) {
  for (const config::Node& node : root.list("sensing")) {
    Sensing instance;
    instance.component = node.text("component");
    instance.name = node.text("name", instance.component);
    instance.arm = read_arm(node, context_);
    instance.model = make_sensor_model(node, context_);
    instance.condition = {LifeCycle::kInactive, ""};
    for (int i = 0; const sensing::Executor* executor = instance.model->executor(i); ++i)
      running_models_.push_back(
          {instance.name + (i == 0 ? "" : "/" + std::to_string(i)), executor});
    sensing_.push_back(std::move(instance));
  }
}

void Pipeline::build_contact(const config::Node& root) {
  int max_nodes = 0;
  for (const config::Node& node : root.list("contact")) {
    Contact instance;
    instance.name = node.text("name", node.text("component"));
    instance.sources = read_sources(node);
    instance.transformer = make_force_transformer(node, context_);
    max_nodes = std::max(max_nodes, instance.transformer->max_nodes());
    contact_.push_back(std::move(instance));
  }
  loads_.resize(contacts_.contacts.size());
  for (contact::ContactLoads& loads : loads_) loads.loads.reserve(max_nodes);
}

/// Gives the model the grasps that the estimator holds, factors for them and lets every slot
/// compute once, so that nothing is done for the first time in the loop.
void Pipeline::warm_up() {
  model_->prepare();
  estimator_->activate(*model_);
  while (elasticity::Refactorisation* job = model_->wanted_refactorisation()) {
    job->run();
    model_->install(*job);
    if (model_->step(context_.period).status != elasticity::StepStatus::kFailed) break;
  }
  feature_->evaluate(model_->positions(), feature_state_.value);
}

void Pipeline::start() noexcept {
  if (whole_.state != LifeCycle::kInactive) return;
  whole_ = {LifeCycle::kActive, ""};
  estimation_condition_ = control_condition_ = {LifeCycle::kActive, ""};
  for (Sensing& instance : sensing_) instance.condition = {LifeCycle::kActive, ""};
  for (Arm& arm : arms_) arm.gate.stop();
  law_->reset();
}

void Pipeline::stop() noexcept {
  if (!is_running()) return;
  whole_ = {LifeCycle::kInactive, "stopped"};
}

void Pipeline::reset() noexcept {
  for (Sensing& instance : sensing_) instance.model->reset();
  estimator_->reset();
  model_->reset();
  estimator_->activate(*model_);
  law_->reset();
  for (Arm& arm : arms_) arm.gate.stop();
  target_.revision = -1;
  whole_ = {LifeCycle::kInactive, "reset"};
}

void Pipeline::zero() noexcept {
  for (Sensing& instance : sensing_) instance.model->zero();
}

void Pipeline::fault(const char* reason) noexcept { whole_ = {LifeCycle::kFaulted, reason}; }

void Pipeline::set_timing_trouble(const char* reason) noexcept {
  if (!is_running()) return;
  whole_ = reason == nullptr ? Condition{LifeCycle::kActive, ""}
                             : Condition{LifeCycle::kDegraded, reason};
}

bool Pipeline::is_running() const noexcept {
  return whole_.state == LifeCycle::kActive || whole_.state == LifeCycle::kDegraded;
}

bool Pipeline::set_target(int revision, const char* kind, const double (*rest_points)[3],
                          int point_count, const double* values, int value_count,
                          const char*& reason) noexcept {
  if (std::strcmp(kind, feature_->kind()) != 0) {
    reason = "target is for another kind of feature";
    return false;
  }
  const std::vector<Eigen::Vector3d>& points = feature_->rest_points();
  if (point_count != 0 && point_count != static_cast<int>(points.size())) {
    reason = "target names another number of points than the feature has";
    return false;
  }
  for (int i = 0; i < point_count; ++i) {
    const Eigen::Map<const Eigen::Vector3d> p(rest_points[i]);
    if (!((p - points[i]).norm() < 1e-6)) {
      reason = "target names other points than the feature has";
      return false;
    }
  }
  if (!feature_->is_valid_target(values, value_count)) {
    reason = "target values are not valid for the feature";
    return false;
  }
  target_.value = Eigen::Map<const Eigen::VectorXd>(values, value_count);
  target_.revision = revision;
  return true;
}

void Pipeline::sense(const sensing::Signals& signals, const sensing::Signals& second) noexcept {
  const std::array<const sensing::Signals*, 2> by_arm = {&signals, &second};
  for (int i = 0; i < arm_count(); ++i) {
    arms_[i].signals = by_arm[i];
    arms_[i].known = by_arm[i]->robot.freshness != sensing::Freshness::kNoData;
  }
  contacts_.count = 0;
  for (Sensing& instance : sensing_) {
    const int first = contacts_.count;
    instance.condition.apply(instance.model->update(*by_arm[instance.arm], contacts_));
    // A model knows one arm, its own.
    for (int i = first; instance.arm == 1 && i < contacts_.count; ++i) {
      if (is_wrist(contacts_.contacts[i].source)) contacts_.contacts[i].source = Source::kWrist1;
    }
  }
  to_object_frame(contacts_);
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

/// False where nobody knows where it is.
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
    contact::ContactLoads& loads = loads_[i];
    const sensing::Contact& contact = contacts_O_.contacts[i];
    loads.source = contact.source;
    loads.accepted = false;
    loads.loads.clear();
    for (Contact& instance : contact_) {
      if (!instance.sources[static_cast<int>(contact.source)]) continue;
      instance.transformer->distribute(contact, model_->positions(), loads);
      loads.source = contact.source;
      break;
    }
  }
}

estimation::GraspInput Pipeline::grasp_input(int grasp) const noexcept {
  const Arm& arm = arms_[grasp];
  estimation::GraspInput input;
  input.pose_freshness = arm.signals->robot.freshness;
  input.X_OG = arm.X_OE() * arm.frames.X_EG;
  // Without a hand that reports its grasp, a robot that reports its pose is taken to hold.
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

void Pipeline::estimate(double dt) noexcept {
  if (!is_running()) return;
  estimation::EstimationInputs& inputs = estimation_inputs_;
  inputs.dt = dt;
  inputs.grasp_count = static_cast<int>(object_.body.grasps.size());
  for (int i = 0; i < inputs.grasp_count; ++i) inputs.grasps[i] = grasp_input(i);
  inputs.contact_count = contacts_O_.count;
  inputs.contacts = loads_.data();
  estimation_condition_.apply(estimator_->update(inputs, *model_, estimate_));
}

void Pipeline::evaluate_feature() noexcept {
  if (!is_running()) return;
  feature_->evaluate(model_->positions(), feature_state_.value);
  if (target_.revision >= 0) {
    feature_->error(feature_state_.value, target_.value, feature_state_.error);
  } else {
    feature_state_.error.setZero();
    feature_state_.unreachable.setZero();
  }
}

void Pipeline::control(double dt) noexcept {
  for (Arm& arm : arms_) arm.requested_W_E = math::Twist();
  if (!is_running() || target_.revision < 0 || !moving_arms_known()) return;
  // A shape that is not known well must not move the robot.
  if (estimation_condition_.state != LifeCycle::kActive) return;

  const int first = moving_ == MovingArms::kSecond ? 1 : 0;
  const math::Pose& X_OG = estimation_inputs_.grasps[first].X_OG;
  if (!provider_->update(*feature_, *model_, X_OG, jacobian_)) {
    control_condition_.apply({sensing::Status::kDegraded, "no Jacobian yet"});
    return;
  }
  control::LawInputs inputs;
  inputs.dt = dt;
  inputs.value = &feature_state_.value;
  inputs.target = &target_.value;
  inputs.error = &feature_state_.error;
  inputs.jacobian = &jacobian_;
  law_->compute(inputs, law_output_);
  control_condition_.apply({sensing::Status::kOk, ""});
  feature_state_.unreachable = law_output_.unreachable;

  request(first, law_output_.V_O_G);
  if (moving_ == MovingArms::kBoth) request(1, law_output_.V_O_G_second);
}

bool Pipeline::moving_arms_known() const noexcept {
  const int grasps = static_cast<int>(object_.body.grasps.size());
  const bool second = moving_ != MovingArms::kFirst;
  if (moving_ != MovingArms::kSecond && (grasps < 1 || !arms_[0].known)) return false;
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

/// In the tick before, while this one's own did not.
bool Pipeline::other_refused(int arm) const noexcept {
  return arm_count() > 1 && arms_[1 - arm].output.refused && !arms_[arm].output.refused;
}

const control::GateOutput& Pipeline::gate(double dt) noexcept {
  const std::array<bool, 2> held_back = {other_refused(0), other_refused(1)};
  for (int i = 0; i < arm_count(); ++i) {
    Arm& arm = arms_[i];
    control::GateInputs inputs;
    inputs.dt = dt;
    inputs.active = is_running() && arm.known && !held_back[i];
    inputs.requested_W_E = arm.requested_W_E;
    if (arm.known) inputs.X_WE = arm.signals->robot.latest.X_WE;
    for (int c = 0; c < contacts_.count; ++c) {
      const sensing::Contact& contact = contacts_.contacts[c];
      if (!is_wrist(contact.source) || wrist(contact.source) != i) continue;
      inputs.wrench_valid = true;
      inputs.contact = contact.wrench;
    }
    arm.output = arm.gate.apply(inputs);
  }
  return arms_[0].output;
}

SensorReport Pipeline::sensor_report(int index) const noexcept {
  const Sensing& instance = sensing_[index];
  SensorReport report{instance.name.c_str(), instance.component.c_str(), instance.condition,
                      instance.model.get()};
  report.condition.component = report.name;
  return report;
}

Condition Pipeline::condition() const noexcept {
  if (!is_running()) return whole_;
  Condition worst = whole_;
  const auto consider = [&worst](const Condition& other) {
    if (static_cast<int>(other.state) > static_cast<int>(worst.state)) worst = other;
  };
  for (int i = 0; i < sensor_count(); ++i) consider(sensor_report(i).condition);
  consider(estimation_condition_);
  consider(control_condition_);
  return worst;
}

}  // namespace palpate::component
