#pragma once

#include <array>
#include <memory>

#include "core/contact/force_transformer.hpp"
#include "core/control/control_law.hpp"
#include "core/control/discrepancy_policy.hpp"
#include "core/control/marker_observer.hpp"
#include "core/control/safety_gate.hpp"
#include "core/estimation/estimator.hpp"
#include "core/sensing/sensor_model.hpp"
#include "core/shape/feature.hpp"
#include "rt/config/node.hpp"
#include "rt/inference/torch_executor.hpp"
#include "rt/registry/arm_model.hpp"
#include "rt/registry/frames.hpp"
#include "rt/registry/object.hpp"

namespace palpate::plugin {
class Plugins;
enum class SensorKind;
}  // namespace palpate::plugin

namespace palpate::registry {

/// Section `inference`: priority (default: one below the loop's) and processor of the threads that
/// run learned models, ignored in deterministic mode, which has no deadlines. Throws config::Error.
inference::TorchExecutorOptions read_inference(const config::Node& root, bool deterministic);

/// Information on the workcell for the construction of components, in addition to their own
/// parameters.
struct Context {
  Frames frames;
  std::optional<Frames> second_frames;        // of the second arm, if present
  std::shared_ptr<const ArmModel> arm_model;  // of the first arm, if modelled
  std::array<control::GateLimits, 2> gate;    // of each arm
  const Object* object = nullptr;             // outlives the component
  double period = 1e-3;                       // s, of the loop
  /// Results must not depend on scheduling: inferences are awaited without limit.
  bool deterministic = false;
  inference::TorchExecutorOptions inference;
  std::shared_ptr<const plugin::Plugins> plugins;  // user components; may be null
  std::vector<std::string>* remarks = nullptr;     // receives warnings, a line each; may be null
};

/// One function per slot: creates the component named by the key "component" of `node` (the
/// controller: "provider" and "law") from the other keys of `node`. Throws config::Error, also for
/// an unknown name, listing the known ones. To add a component: add it to its slot's .cpp, or load
/// it from a library (plugins.hpp).
std::unique_ptr<sensing::SensorModel> make_sensor_model(const config::Node& node,
                                                        const Context& context);
std::unique_ptr<contact::ForceTransformer> make_force_transformer(const config::Node& node,
                                                                  const Context& context);
std::unique_ptr<estimation::Estimator> make_estimator(const config::Node& node,
                                                      const Context& context);
std::unique_ptr<elasticity::DeformationModel> make_deformation_model(const config::Node& node,
                                                                     const Context& context);
std::unique_ptr<shape::Feature> make_feature(const config::Node& node, const Context& context);
/// `feature`: the feature concerned, evaluated on the rest shape.
std::unique_ptr<control::JacobianProvider> make_jacobian_provider(const config::Node& node,
                                                                  const Context& context,
                                                                  shape::Feature& feature);
/// Key `vision` of the controller; null without vision.
std::unique_ptr<control::MarkerObserver> make_marker_observer(const config::Node& node,
                                                              const Context& context,
                                                              const shape::Feature& feature);
/// Configured for `feature`.
std::unique_ptr<control::ControlLaw> make_control_law(const config::Node& node,
                                                      const Context& context,
                                                      const shape::Feature& feature);

/// Limits from the section `gate`; missing entries are taken from `otherwise`.
control::GateLimits read_gate_limits(const config::Node& root,
                                     const control::GateLimits& otherwise = {});

/// Arms moved by the controller.
enum class MovingArms { kFirst, kSecond, kBoth };
MovingArms read_moving_arms(const config::Node& control, const Context& context);

/// Key `command` of the controller: whether it commands joints instead of the hand's twist.
bool read_commands_joints(const config::Node& control, const Context& context);

/// Keys of the controller for wrenches that contradict the model.
control::DiscrepancyPolicy read_discrepancy_policy(const config::Node& control);

/// Key `arm` of a sensor model: 0, or 1 with a second arm.
int read_arm(const config::Node& node, const Context& context);

/// Kind of sensor of the sensor model of that name.
plugin::SensorKind sensor_kind(const std::string& name, const Context& context);

}  // namespace palpate::registry
