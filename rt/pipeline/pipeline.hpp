#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/control/joint_gate.hpp"
#include "core/control/safety_gate.hpp"
#include "core/frames/arm_frames.hpp"
#include "rt/pipeline/estimate_trust.hpp"
#include "rt/pipeline/jaw_watch.hpp"
#include "rt/pipeline/obstacle_motion.hpp"
#include "rt/pipeline/replacement.hpp"

namespace palpate::pipeline {

/// What the sensor model of a wrist has made of its reading in this tick.
struct WristReport {
  UpdateResult result;
  const sensing::Contact* contact = nullptr;  // in S; nullptr: no wrench
  double reading_time = 0;                    // s, of the latest reading, clock of its sender
  double age = -1;                            // s since its arrival; negative: none yet
};

/// Phases of a tick over the components in the six slots, for one or two arms with their gates.
/// Everything is built and configured by the constructor; the phases neither allocate, lock, log
/// nor throw.
class Pipeline {
 public:
  /// Reads the sections frames, object, sensing, contact, estimation, deformation, feature, control
  /// and gate. `deterministic`: results depend on the inputs only, not on thread scheduling. Throws
  /// config::Error.
  Pipeline(const config::Node& root, double period, bool deterministic = false);
  ~Pipeline();

  /// Set-up, before the first tick: replaces the sensor model of `instance` by an externally
  /// constructed one, and returns the previous one.
  std::unique_ptr<sensing::SensorModel> exchange_sensor_model(
      int instance, std::unique_ptr<sensing::SensorModel> model);

  /// Set-up, before the first tick: access for inserting externally constructed components.
  ComponentSet& components_at_setup() noexcept { return *components_; }

  // Life-cycle events; safe in the loop.
  /// "" or why it is refused: also where messages contradict the configured frames.
  const char* start() noexcept;
  void stop(const char* reason = "stopped") noexcept;
  void reset() noexcept;                    // rest shape, faults cleared, inactive
  void zero() noexcept;                     // tares every sensor model
  void fault(const char* reason) noexcept;  // fault latched by an external supervisor
  /// Set by an external supervisor in each tick; degraded while there is a timing problem.
  void set_timing(const UpdateResult& timing) noexcept;

  /// False, with the reason, if kind, points or values do not match the feature in its slot.
  bool set_target(int revision, const char* kind, const double (*rest_points)[3], int point_count,
                  const double* values, int value_count, const char*& reason) noexcept;

  /// Guarded motion of the first arm, by the law guarded_motion. begin_touch(): "" or why it is
  /// refused.
  const char* begin_touch(const control::TouchRequest& request) noexcept;
  void cancel_touch() noexcept;
  /// State of the last one; nullptr with another law.
  const control::TouchReport* touch_report() const noexcept {
    return components_->guarded_motion == nullptr ? nullptr
                                                  : &components_->guarded_motion->report();
  }

  /// For a Replacement, which is built elsewhere. The snapshot has the present mesh's size and is
  /// filled by the loop's thread.
  const ComponentSet& components() const noexcept { return *components_; }
  ShapeSnapshot room_for_shape() const;
  void copy_shape(ShapeSnapshot& snapshot) const noexcept;

  /// Called once per tick after a replacement has been built, after sense(): runs new sensor models
  /// in parallel until they are ready. kReady: call take(); kRejected: `reason` contains the
  /// reason, and nothing has changed.
  enum class WarmupState { kRunning, kReady, kRejected };
  WarmupState warm_up(Replacement& replacement, const char*& reason) noexcept;

  /// Called between two ticks: exchanges all new components together; they continue from the state
  /// of the previous ones, which `replacement` then holds for destruction by another thread. No
  /// factorisation for the present model may be in progress. False if the state cannot be
  /// transferred; then nothing has changed.
  bool take(Replacement& replacement) noexcept;

  /// A component that faults is replaced within the same tick by its `fallback`, if configured, and
  /// the pipeline is degraded until reset(), which restores the original one. Number of such
  /// replacements, and reason of the last one: "slot: fallback, since ...".
  int fallbacks_taken() const noexcept { return fallbacks_taken_; }
  const char* fallback_reason() const noexcept { return fallback_reason_.data(); }
  bool on_fallback() const noexcept { return fallbacks_->in_use() || components_->on_fallback(); }
  /// Sets fallbacks that match the components after a replacement.
  void take(std::unique_ptr<Fallbacks>& fallbacks) noexcept { fallbacks_.swap(fallbacks); }

  // Phases of one tick, in this order. While inactive nothing is estimated and the gate outputs
  // zero.
  /// `second`: signals of the second arm; ignored without one.
  void sense(const sensing::Signals& signals, const sensing::Signals& second) noexcept;
  void sense(const sensing::Signals& signals) noexcept { sense(signals, signals); }
  void distribute() noexcept;
  void estimate(double dt) noexcept;
  void evaluate_feature() noexcept;
  void control(double dt) noexcept;
  /// Output for the first arm. If the gate of one arm rejects a command, the other arm stops as
  /// well, because both may hold the same object.
  const control::GateOutput& gate(double dt) noexcept;
  const control::GateOutput& gate_output(int arm) const noexcept { return arms_[arm].output; }

  Condition condition() const noexcept;  // worst condition of all slots
  /// What the policy `control.on_discrepancy` does now; kContinue also while nothing contradicts
  /// the model. Reason of the last discrepancy, with that action.
  control::DiscrepancyAction discrepancy_action() const noexcept;
  const char* discrepancy_reason() const noexcept { return trust_.reason(); }
  bool is_running() const noexcept;

  /// Without an object, sense() is the only phase that does anything: there is no model, estimate
  /// or feature, and the object is empty.
  bool has_object() const noexcept { return components_->model != nullptr; }
  const registry::Object& object() const noexcept { return *components_->object; }
  const std::vector<RunningModel>& running_models() const noexcept {
    return components_->running_models;
  }
  int sensor_count() const noexcept { return static_cast<int>(components_->sensing.size()); }
  SensorReport sensor_report(int index) const noexcept { return components_->sensor_report(index); }
  /// Warnings of the constructor, a line each: settings that the system rejected for threads of
  /// components, and values of the configuration that hardly mean what was intended.
  const std::vector<std::string>& remarks() const noexcept { return remarks_; }
  int arm_count() const noexcept { return static_cast<int>(arms_.size()); }
  /// Whether an arm is commanded by joint velocities rather than a twist.
  bool commands_joints(int arm) const noexcept { return arm == 0 && components_->commands_joints; }
  /// Number of joints of the first arm; 0 without a model of it.
  int joint_count() const noexcept {
    return cell_.arm_model ? cell_.arm_model->chain.joint_count() : 0;
  }
  const registry::Frames& frames(int arm = 0) const noexcept { return arms_[arm].frames; }
  elasticity::DeformationModel& model() noexcept { return *components_->model; }
  const elasticity::DeformationModel& model() const noexcept { return *components_->model; }
  const estimation::Estimate& estimate() const noexcept { return components_->estimate; }
  const shape::Feature& feature() const noexcept { return *components_->feature; }
  const FeatureState& feature_state() const noexcept { return components_->feature_state; }
  const Target& target() const noexcept { return components_->target; }
  /// Hands that open and close; a grasp that it wants is found by a Replacement of the object.
  JawWatch& jaws() noexcept { return *jaws_; }
  /// Where the obstacles of the configuration are.
  const ObstacleMotion& obstacles() const noexcept { return *obstacles_; }
  /// Contacts in O, for display and estimation.
  const sensing::ContactSet& contacts() const noexcept { return contacts_O_; }
  /// After sense(). Empty without a sensor model of that arm's wrist; of several, the last one's.
  std::optional<WristReport> wrist(int arm) const noexcept;

 private:
  struct Arm {
    Arm(const registry::Frames& its_frames, const control::GateLimits& limits)
        : frames(its_frames), gate(limits) {}

    registry::Frames frames;
    control::SafetyGate gate;
    const sensing::Signals* signals = nullptr;  // signals of this tick
    bool known = false;                         // its robot has reported a pose
    control::GateInputs gate_inputs;            // of this tick
    control::GateOutput output;
    // Set if the arm is modelled.
    std::shared_ptr<const registry::ArmModel> model;
    std::optional<control::JointGate> joint_gate;
    kinematics::SerialChain::State kinematics;
    bool joints_known = false;  // known and consistent with the reported flange pose
    kinematics::SerialChain::Joints requested_joints;

    frames::ArmMeasurements measurements() const noexcept { return {frames, *signals, known}; }
  };
  void build_arms(const config::Node& root);
  void exchange(Replacement& replacement) noexcept;
  void report_fallback(const char* slot, const char* reason) noexcept;
  void check_loads(ComponentSet::Contact& instance, contact::ContactLoads& loads) noexcept;
  bool feature_is_sound() noexcept;
  void place_obstacles() noexcept;
  void update_markers() noexcept;
  const Eigen::Matrix3Xd& observed_positions() const noexcept;
  bool observe(double dt, int first) noexcept;
  bool fall_back(Fallback& fallback, const char* slot, const char* reason) noexcept;
  bool steer(double dt, int first) noexcept;
  const char* distrust() const noexcept;
  bool is_trusted() const noexcept { return distrust() == nullptr; }
  void move_guarded(double dt) noexcept;
  bool moving_arms_known() const noexcept;
  double request(int arm, const math::Twist& V_O_G) noexcept;
  static void find_joints(Arm& arm) noexcept;
  static const char* wrong_frames(const Arm& arm) noexcept;
  static control::JointInputs joint_inputs(const Arm& arm) noexcept;
  static void pass_gate(Arm& arm, bool as_joints) noexcept;
  bool other_rejected(int arm) const noexcept;

  std::vector<std::string> remarks_;
  registry::Context cell_;
  std::vector<Arm> arms_;  // one or two
  std::unique_ptr<ObstacleMotion> obstacles_;
  Condition obstacle_condition_;
  std::unique_ptr<JawWatch> jaws_;
  Condition jaw_condition_;
  std::unique_ptr<ComponentSet> components_;
  Condition whole_;
  std::unique_ptr<Fallbacks> fallbacks_;
  int fallbacks_taken_ = 0;
  std::array<char, 200> fallback_reason_{};
  EstimateTrust trust_;

  sensing::ContactSet contacts_;    // in the frames of the sensors
  sensing::ContactSet contacts_O_;  // in O
  estimation::EstimationInputs estimation_inputs_;
};

}  // namespace palpate::pipeline
