#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/control/joint_gate.hpp"
#include "core/control/safety_gate.hpp"
#include "rt/pipeline/fallbacks.hpp"

namespace palpate::pipeline {

/// The phases of a tick over the components in the six slots, for one or two arms with their gates.
/// Everything is built and configured by the constructor; the phases neither allocate, lock, log
/// nor throw.
class Pipeline {
 public:
  /// Reads frames, object, sensing, contact, estimation, deformation, feature, control, gate.
  /// `deterministic`: what follows depends on the inputs alone, not on how threads are scheduled.
  /// Throws config::Error.
  Pipeline(const config::Node& root, double period, bool deterministic = false);
  ~Pipeline();

  /// Set-up, before the first tick: puts a sensor model that was made elsewhere in the place of the
  /// one that `instance` holds, and gives that one away.
  std::unique_ptr<sensing::SensorModel> exchange_sensor_model(
      int instance, std::unique_ptr<sensing::SensorModel> model);

  /// Set-up, before the first tick: to put in what was made elsewhere.
  Slots& slots_at_setup() noexcept { return *slots_; }

  // Events; each is safe in the loop.
  void start() noexcept;
  void stop(const char* reason = "stopped") noexcept;
  void reset() noexcept;                    // rest shape, faults cleared, inactive
  void zero() noexcept;                     // tare of every sensor model
  void fault(const char* reason) noexcept;  // latched by a supervisor outside
  /// Said by a supervisor outside each tick; nullptr when nothing is wrong (any more).
  void set_timing_trouble(const char* reason) noexcept;

  /// False, with the reason, where kind, points or values do not fit the feature in its slot.
  bool set_target(int revision, const char* kind, const double (*rest_points)[3], int point_count,
                  const double* values, int value_count, const char*& reason) noexcept;

  /// For a Replacement, which is built elsewhere. The snapshot has the present mesh's size already
  /// and is filled by the loop's thread.
  const Slots& slots() const noexcept { return *slots_; }
  ShapeSnapshot room_for_shape() const;
  void copy_shape(ShapeSnapshot& snapshot) const noexcept;

  /// Once a tick from when it has been built, after sense(): lets new sensor models run along until
  /// they are ready. kReady: take() it; kRefused: `reason` says why, and nothing has changed.
  enum class Along { kWaits, kReady, kRefused };
  Along run_along(Replacement& replacement, const char*& reason) noexcept;

  /// Between two ticks: puts the new components in, which go on from the present ones' state, all
  /// at once; `replacement` then holds those that were replaced, for another thread to destroy. No
  /// factor for the present model may be under way. False where the state cannot be carried; then
  /// nothing has changed.
  bool take(Replacement& replacement) noexcept;

  /// Where a component faults that has a `fallback`, that one takes its place in the same tick and
  /// the whole is degraded until reset(), which puts the first one back. How many did so far, and
  /// why the last one did: "slot: fallback, since ...".
  int fallbacks_taken() const noexcept { return fallbacks_taken_; }
  const char* fallback_reason() const noexcept { return fallback_reason_.data(); }
  bool on_fallback() const noexcept { return fallbacks_->in_use() || slots_->on_fallback(); }
  /// After components were replaced: those that fit the new ones.
  void take(std::unique_ptr<Fallbacks>& fallbacks) noexcept { fallbacks_.swap(fallbacks); }

  // Phases of one tick, in this order. While inactive they keep estimating nothing and the gate
  // gives zero.
  /// `second`: what the second arm says; ignored where there is none.
  void sense(const sensing::Signals& signals, const sensing::Signals& second) noexcept;
  void sense(const sensing::Signals& signals) noexcept { sense(signals, signals); }
  void distribute() noexcept;
  void estimate(double dt) noexcept;
  void evaluate_feature() noexcept;
  void control(double dt) noexcept;
  /// Of the first arm. Where one arm's gate refuses, the other arm stops as well: both may hold the
  /// same object.
  const control::GateOutput& gate(double dt) noexcept;
  const control::GateOutput& gate_output(int arm) const noexcept { return arms_[arm].output; }

  Condition condition() const noexcept;  // the worst of all slots
  bool is_running() const noexcept;

  const registry::Object& object() const noexcept { return *slots_->object; }
  const std::vector<RunningModel>& running_models() const noexcept {
    return slots_->running_models;
  }
  int sensor_count() const noexcept { return static_cast<int>(slots_->sensing.size()); }
  SensorReport sensor_report(int index) const noexcept { return slots_->sensor_report(index); }
  /// Warnings, a line each, of the constructor: what the system did not grant to threads of
  /// components, and what of the configuration hardly is as it was meant.
  const std::vector<std::string>& remarks() const noexcept { return remarks_; }
  int arm_count() const noexcept { return static_cast<int>(arms_.size()); }
  /// Whether joint velocities are what an arm is told, not a twist.
  bool commands_joints(int arm) const noexcept { return arm == 0 && slots_->commands_joints; }
  /// Of the first arm; 0 where there is no model of it.
  int joint_count() const noexcept {
    return cell_.arm_model ? cell_.arm_model->chain.joint_count() : 0;
  }
  const registry::Frames& frames(int arm = 0) const noexcept { return arms_[arm].frames; }
  elasticity::DeformationModel& model() noexcept { return *slots_->model; }
  const elasticity::DeformationModel& model() const noexcept { return *slots_->model; }
  const estimation::Estimate& estimate() const noexcept { return slots_->estimate; }
  const shape::Feature& feature() const noexcept { return *slots_->feature; }
  const FeatureState& feature_state() const noexcept { return slots_->feature_state; }
  const Target& target() const noexcept { return slots_->target; }
  /// In O, for display and estimation.
  const sensing::ContactSet& contacts() const noexcept { return contacts_O_; }

 private:
  struct Arm {
    Arm(const registry::Frames& its_frames, const control::GateLimits& limits)
        : frames(its_frames), gate(limits) {}

    registry::Frames frames;
    control::SafetyGate gate;
    const sensing::Signals* signals = nullptr;  // of this tick
    bool known = false;                         // its robot has told where it is
    math::Twist requested_W_E;
    control::GateOutput output;
    // Where there is a model of the arm.
    std::shared_ptr<const registry::ArmModel> model;
    std::optional<control::JointGate> joint_gate;
    kinematics::SerialChain::State kinematics;
    bool joints_known = false;  // and put the flange where the robot says that it is
    kinematics::SerialChain::Joints requested_joints;

    math::Pose X_OE() const noexcept { return frames.X_WO.inverse() * signals->robot.latest.X_WE; }
  };
  void build_arms(const config::Node& root);
  void put_in(Replacement& replacement) noexcept;
  void tell_fallback(const char* slot, const char* reason) noexcept;
  void check_loads(Slots::Contact& instance, contact::ContactLoads& loads) noexcept;
  bool feature_is_sound() noexcept;
  void look_at_markers() noexcept;
  const Eigen::Matrix3Xd& seen_positions() const noexcept;
  bool look_and_learn(double dt, int first) noexcept;
  bool fall_back(Fallback& fallback, const char* slot, const char* reason) noexcept;
  bool steer(double dt, int first) noexcept;
  void to_object_frame(const sensing::ContactSet& contacts) noexcept;
  bool locate_wrist(sensing::Contact& contact) const noexcept;
  bool locate_finger(sensing::Contact& contact) const noexcept;
  estimation::GraspInput grasp_input(int grasp) const noexcept;
  void take_observation(estimation::ObservationInput& input) const noexcept;
  bool is_trusted() const noexcept;
  bool moving_arms_known() const noexcept;
  void request(int arm, const math::Twist& V_O_G) noexcept;
  static void find_joints(Arm& arm) noexcept;
  control::JointInputs joint_inputs(const Arm& arm) const noexcept;
  void pass_gate(Arm& arm, const control::GateInputs& inputs, bool as_joints) noexcept;
  bool other_refused(int arm) const noexcept;

  std::vector<std::string> remarks_;
  registry::Context cell_;
  std::vector<Arm> arms_;  // one or two
  std::unique_ptr<Slots> slots_;
  Condition whole_;
  std::unique_ptr<Fallbacks> fallbacks_;
  int fallbacks_taken_ = 0;
  std::array<char, 200> fallback_reason_{};

  sensing::ContactSet contacts_;    // in the sensors' frames
  sensing::ContactSet contacts_O_;  // in O
  estimation::EstimationInputs estimation_inputs_;
};

}  // namespace palpate::pipeline
