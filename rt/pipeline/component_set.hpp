#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/control/discrepancy_policy.hpp"
#include "core/control/guarded_motion.hpp"
#include "rt/pipeline/life_cycle.hpp"
#include "rt/pipeline/shape_watch.hpp"
#include "rt/plugin/supervision.hpp"
#include "rt/registry/fallbacks.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::pipeline {

/// Target of the feature.
struct Target {
  int revision = -1;  // -1: none
  Eigen::VectorXd value;
};

/// Outputs of the feature and control slots after a tick.
struct FeatureState {
  Eigen::VectorXd value;
  Eigen::VectorXd error;        // target minus value; zero without a target
  Eigen::VectorXd unreachable;  // component of the error that no grasp motion removes
};

/// Learned model of a component.
struct RunningModel {
  std::string name;  // name of the component's instance, "name/1" for its second model
  const sensing::Executor* executor = nullptr;
};

/// State of one instance of the sensing slot.
struct SensorReport {
  const char* name = "";       // name of the instance
  const char* component = "";  // component type, e.g. ft_rnnob
  Condition condition;
  const sensing::SensorModel* model = nullptr;
};

/// Components to be built for a configuration. Components that refer to each other are built
/// together: estimator and deformation model, feature and controller; a new object requires all of
/// them and the contacts.
struct Changes {
  bool object = false;
  bool contact = false;
  bool mechanics = false;     // estimation and deformation
  bool steering = false;      // feature and control
  std::vector<bool> sensing;  // by instance
  /// Of a configuration without an object only the sensor models.
  static Changes all(const config::Node& root);
  bool any() const noexcept;
};

/// Whether the configuration has sensor models and nothing of an object: the daemon then senses,
/// and neither estimates nor commands anything.
bool senses_only(const config::Node& root);

/// Components in the six slots, the object to which they refer, and their workspace. Sensing and
/// contact contain lists, the other slots one component each. Without an object (senses_only) there
/// are sensor models only, and `object` is empty.
struct ComponentSet {
  static constexpr std::size_t kMostSensors = 16;
  struct Sensing {
    std::string name;
    std::string component;
    int arm = 0;
    std::unique_ptr<sensing::SensorModel> model;
    registry::SensorFallback* fallback = nullptr;  // the model, if it has a fallback
    Condition condition{LifeCycle::kInactive, ""};
    bool fallback_reported = false;  // use of the fallback has been reported
    bool is_wrist = false;           // measures the wrist of its arm
    bool reads_joints = false;       // by ROBOT_STATE, not by FT_WRENCH
    UpdateResult result;             // of the last update, also while the daemon is inactive
  };
  struct Contact {
    std::string name;
    std::unique_ptr<contact::ForceTransformer> transformer;
    registry::ContactFallback* fallback = nullptr;  // the transformer, if it has a fallback
    std::array<bool, 8> sources{};                  // by sensing::Source
    Condition condition{LifeCycle::kInactive, ""};
    bool fallback_reported = false;  // use of the fallback has been reported
  };

  /// Builds and configures the components selected by `changes`; others remain empty. `cell`:
  /// frames, period and mode; `present`: the object to keep if it does not change. Throws
  /// config::Error; where a plug-in does not return, all that was built is kept for ever, since an
  /// abandoned thread may use it.
  ComponentSet(const config::Node& root, const registry::Context& cell, const Changes& changes,
               std::shared_ptr<const registry::Object> present);

  /// Sets the grasps held as required by the estimator, factors for them and evaluates every
  /// component once, so that no operation is executed for the first time in the loop. Applies to
  /// the components that were built.
  /// Throws config::Error if a plug-in throws or does not return; then all components are kept for
  /// ever.
  void warm_up();
  void check_warm_up(const plugin::SetupScope& scope);

  /// Takes from `other` the components not selected by `changes`, and the state of the selected
  /// ones. `successors`: by sensor model, index of the one in `other` that it replaces, or -1.
  void adopt(ComponentSet& other, const Changes& changes,
             const std::vector<int>& successors) noexcept;

  void start() noexcept;
  void reset() noexcept;
  /// False, with the reason, if kind, points or values do not match the feature.
  bool set_target(int revision, const char* kind, const double (*rest_points)[3], int point_count,
                  const double* values, int value_count, const char*& reason) noexcept;
  SensorReport sensor_report(int index) const noexcept;
  Condition worst_of(const Condition& whole) const noexcept;
  bool on_fallback() const noexcept;  // of a sensor model or a contact

  std::shared_ptr<const registry::Object> object;
  registry::Context context;
  std::vector<Sensing> sensing;
  std::vector<RunningModel> running_models;
  std::vector<Contact> contact;
  std::unique_ptr<elasticity::DeformationModel> model;
  std::unique_ptr<estimation::Estimator> estimator;
  std::unique_ptr<shape::Feature> feature;
  std::unique_ptr<control::JacobianProvider> provider;
  std::unique_ptr<control::ControlLaw> law;
  control::GuardedMotion* guarded_motion = nullptr;  // the law, if it is one
  /// Null: the feature is evaluated on the model.
  std::unique_ptr<control::MarkerObserver> markers;
  registry::MovingArms moving = registry::MovingArms::kFirst;
  bool commands_joints = false;  // of the first arm, instead of its hand's twist
  control::DiscrepancyPolicy on_discrepancy;

  Condition estimation_condition;
  Condition feature_condition;
  Condition control_condition;

  std::vector<contact::ContactLoads> loads;  // by contact of the tick
  estimation::Estimate estimate;
  ShapeWatch shape_watch;
  Target target;
  FeatureState feature_state;
  Eigen::MatrixXd jacobian;
  control::LawOutput law_output;

 private:
  void build(const config::Node& root, const Changes& changes);
  void keep_for_ever();
  void list_running_models(const Sensing& instance);
  /// Includes the fallback, if the section names one.
  void make_model(const config::Node& node, Sensing& instance);
  void make_transformer(const config::Node& node, Contact& instance);
  void build_sensing(const config::Node& root, const Changes& changes);
  void build_contact(const config::Node& root);
  void build_steering(const config::Node& root);
};

}  // namespace palpate::pipeline
