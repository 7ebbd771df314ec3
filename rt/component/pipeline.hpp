#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/control/safety_gate.hpp"
#include "rt/component/life_cycle.hpp"
#include "rt/component/registry.hpp"

namespace palpate::component {

/// Where the feature shall go.
struct Target {
  int revision = -1;  // -1: none
  Eigen::VectorXd value;
};

/// What the feature and control slots hold after a tick.
struct FeatureState {
  Eigen::VectorXd value;
  Eigen::VectorXd error;        // target minus value; zero without a target
  Eigen::VectorXd unreachable;  // the part of error that no motion of the grasp removes
};

/// A learned model that a component runs.
struct RunningModel {
  std::string name;  // of the component's instance, "name/1" for its second model
  const sensing::Executor* executor = nullptr;
};

/// How one instance of the sensing slot does.
struct SensorReport {
  const char* name = "";       // of the instance
  const char* component = "";  // what it is, e.g. ft_rnnob
  Condition condition;
  const sensing::SensorModel* model = nullptr;
};

/// The six slots: sensing and contact hold lists, the others one component each. Everything is
/// built and configured by the constructor; the phases of a tick neither allocate, lock, log nor
/// throw.
class Pipeline {
 public:
  /// Reads frames, object, sensing, contact, estimation, deformation, feature, control, gate.
  /// `deterministic`: what follows depends on the inputs alone, not on how threads are scheduled.
  /// Throws config::Error.
  Pipeline(const config::Node& root, double period, bool deterministic = false);
  ~Pipeline();

  // Events; each is safe in the loop.
  void start() noexcept;
  void stop() noexcept;
  void reset() noexcept;                    // rest shape, faults cleared, inactive
  void zero() noexcept;                     // tare of every sensor model
  void fault(const char* reason) noexcept;  // latched by a supervisor outside
  /// Said by a supervisor outside each tick; nullptr when nothing is wrong (any more).
  void set_timing_trouble(const char* reason) noexcept;

  /// False, with the reason, where kind, points or values do not fit the feature in its slot.
  bool set_target(int revision, const char* kind, const double (*rest_points)[3], int point_count,
                  const double* values, int value_count, const char*& reason) noexcept;

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

  const Object& object() const noexcept { return object_; }
  const std::vector<RunningModel>& running_models() const noexcept { return running_models_; }
  int sensor_count() const noexcept { return static_cast<int>(sensing_.size()); }
  SensorReport sensor_report(int index) const noexcept;
  /// What the system did not grant to threads of components, a line each.
  const std::vector<std::string>& remarks() const noexcept { return remarks_; }
  int arm_count() const noexcept { return static_cast<int>(arms_.size()); }
  const Frames& frames(int arm = 0) const noexcept { return arms_[arm].frames; }
  elasticity::DeformationModel& model() noexcept { return *model_; }
  const estimation::Estimate& estimate() const noexcept { return estimate_; }
  const shape::Feature& feature() const noexcept { return *feature_; }
  const FeatureState& feature_state() const noexcept { return feature_state_; }
  const Target& target() const noexcept { return target_; }
  /// In O, for display and estimation.
  const sensing::ContactSet& contacts() const noexcept { return contacts_O_; }

 private:
  struct Arm {
    Frames frames;
    control::SafetyGate gate;
    const sensing::Signals* signals = nullptr;  // of this tick
    bool known = false;                         // its robot has told where it is
    math::Twist requested_W_E;
    control::GateOutput output;

    math::Pose X_OE() const noexcept { return frames.X_WO.inverse() * signals->robot.latest.X_WE; }
  };
  struct Sensing {
    std::string name;
    std::string component;
    int arm = 0;
    std::unique_ptr<sensing::SensorModel> model;
    Condition condition;
  };
  struct Contact {
    std::string name;
    std::unique_ptr<contact::ForceTransformer> transformer;
    std::array<bool, 8> sources{};  // by sensing::Source
  };

  void build_arms(const config::Node& root);
  void build_sensing(const config::Node& root);
  void build_contact(const config::Node& root);
  void warm_up();
  void to_object_frame(const sensing::ContactSet& contacts) noexcept;
  bool locate_wrist(sensing::Contact& contact) const noexcept;
  bool locate_finger(sensing::Contact& contact) const noexcept;
  estimation::GraspInput grasp_input(int grasp) const noexcept;
  bool moving_arms_known() const noexcept;
  void request(int arm, const math::Twist& V_O_G) noexcept;
  bool other_refused(int arm) const noexcept;

  std::vector<std::string> remarks_;
  Context context_;
  Object object_;
  std::vector<Arm> arms_;  // one or two
  std::vector<Sensing> sensing_;
  std::vector<RunningModel> running_models_;
  std::vector<Contact> contact_;
  std::unique_ptr<elasticity::DeformationModel> model_;
  std::unique_ptr<estimation::Estimator> estimator_;
  std::unique_ptr<shape::Feature> feature_;
  std::unique_ptr<control::JacobianProvider> provider_;
  std::unique_ptr<control::ControlLaw> law_;
  MovingArms moving_ = MovingArms::kFirst;

  Condition estimation_condition_;
  Condition control_condition_;
  Condition whole_;

  sensing::ContactSet contacts_;    // in the sensors' frames
  sensing::ContactSet contacts_O_;  // in O
  std::vector<contact::ContactLoads> loads_;
  estimation::EstimationInputs estimation_inputs_;
  estimation::Estimate estimate_;
  Target target_;
  FeatureState feature_state_;
  Eigen::MatrixXd jacobian_;
  control::LawOutput law_output_;
};

}  // namespace palpate::component
