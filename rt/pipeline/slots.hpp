#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/estimation/shape_jump.hpp"
#include "rt/pipeline/life_cycle.hpp"
#include "rt/registry/contact_fallback.hpp"
#include "rt/registry/registry.hpp"
#include "rt/registry/sensor_fallback.hpp"

namespace palpate::pipeline {

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

/// What of a configuration is to be built. Components that refer to each other are built together:
/// estimator and deformation model, feature and controller; a new object takes all of them and the
/// contacts.
struct Changes {
  bool object = false;
  bool contact = false;
  bool mechanics = false;     // estimation and deformation
  bool steering = false;      // feature and control
  std::vector<bool> sensing;  // by instance
  static Changes all(const config::Node& root);
  bool any() const noexcept;
};

/// The components in the six slots, the object that they speak of and the room that they compute
/// in. Sensing and contact hold lists, the other slots one component each.
struct Slots {
  static constexpr std::size_t kMostSensors = 16;
  struct Sensing {
    std::string name;
    std::string component;
    int arm = 0;
    std::unique_ptr<sensing::SensorModel> model;
    registry::SensorFallback* fallback = nullptr;  // the model, where it has one to fall back on
    Condition condition{LifeCycle::kInactive, ""};
    bool told = false;  // that the fallback is in use
  };
  struct Contact {
    std::string name;
    std::unique_ptr<contact::ForceTransformer> transformer;
    registry::ContactFallback* fallback =
        nullptr;                    // the transformer, where it has one to fall back on
    std::array<bool, 8> sources{};  // by sensing::Source
    Condition condition{LifeCycle::kInactive, ""};
    bool told = false;  // that the fallback is in use
  };

  /// Builds and configures what `changes` names; the rest stays empty. `cell` tells frames, period
  /// and mode; `present`: the object that stays where it does not change. Throws config::Error.
  Slots(const config::Node& root, const registry::Context& cell, const Changes& changes,
        std::shared_ptr<const registry::Object> present);

  /// Gives the model the grasps that the estimator holds, factors for them and lets every component
  /// compute once, so that nothing is done for the first time in the loop. Of those that were
  /// built.
  void warm_up();

  /// Takes from `other` the components that `changes` does not name, and the state of those that it
  /// does. `successors`: by sensor model, that of the other in whose place it comes, or -1.
  void adopt(Slots& other, const Changes& changes, const std::vector<int>& successors) noexcept;

  void start() noexcept;
  void reset() noexcept;
  /// False, with the reason, where kind, points or values do not fit the feature.
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
  std::unique_ptr<published_control::MarkerSight> sight;  // null: the feature is the model's
  registry::MovingArms moving = registry::MovingArms::kFirst;
  bool commands_joints = false;  // of the first arm, in place of its hand's twist

  Condition estimation_condition;
  Condition feature_condition;
  Condition control_condition;

  std::vector<contact::ContactLoads> loads;  // by contact of the tick
  estimation::Estimate estimate;
  estimation::ShapeJump jump;  // of the model's shape
  Target target;
  FeatureState feature_state;
  Eigen::MatrixXd jacobian;
  control::LawOutput law_output;

 private:
  void list_running_models(const Sensing& instance);
  /// With the fallback that the section names, where it names one.
  void make_model(const config::Node& node, Sensing& instance);
  void make_transformer(const config::Node& node, Contact& instance);
  void build_sensing(const config::Node& root, const Changes& changes);
  void build_contact(const config::Node& root);
  void build_steering(const config::Node& root);
};

}  // namespace palpate::pipeline
