#include "core/estimation/fingertip_driven.hpp"
#include "core/estimation/force_driven.hpp"
#include "core/estimation/pose_driven.hpp"
#include "rt/component/registry.hpp"

namespace palpate::component {
namespace {

std::unique_ptr<estimation::Estimator> make_force_driven(const config::Node& node,
                                                         const Context& context) {
  using estimation::ForceDriven;
  ForceDriven::Options options;
  const std::string filters = node.choice("filters", {"control", "sensing"}, "control");
  if (filters == "sensing") options = ForceDriven::Options::sensing_launch();
  options.variant = node.choice("variant", {"as_released", "repaired"}, "repaired") == "repaired"
                        ? ForceDriven::Variant::kRepaired
                        : ForceDriven::Variant::kAsReleased;
  options.fade = node.number("fade_ms", {1, 1e4}, options.fade * 1e3) * 1e-3;
  options.average = node.number("average_ms", {0, 1e4}, options.average * 1e3) * 1e-3;
  options.delay = node.number("delay_ms", {0, 1e4}, options.delay * 1e3) * 1e-3;
  options.period = context.period;
  return std::make_unique<ForceDriven>(context.object->body, options);
}

std::unique_ptr<estimation::Estimator> make_fingertip_driven(const config::Node& node,
                                                             const Context& context) {
  using estimation::FingertipDriven;
  FingertipDriven::Options options;
  options.skin_stiffness = node.number("skin_stiffness", {1, 1e7}, options.skin_stiffness);
  options.friction = node.number("friction", {0.01, 10}, options.friction);
  options.slide = node.number("slide", {1e-5, 0.1}, options.slide);
  options.patience = node.number("patience_ms", {1, 1e4}, options.patience * 1e3) * 1e-3;
  options.approach_speed = node.number("approach_speed", {1e-3, 10}, options.approach_speed);
  return std::make_unique<FingertipDriven>(context.object->body, context.object->surface, options);
}

}  // namespace

std::unique_ptr<estimation::Estimator> make_estimator(const config::Node& node,
                                                      const Context& context) {
  const std::string name =
      node.choice("component", {"pose_driven", "force_driven", "fingertip_driven"});
  try {
    if (name == "force_driven") return make_force_driven(node, context);
    if (name == "fingertip_driven") return make_fingertip_driven(node, context);
    estimation::PoseDriven::Options options;
    options.pose_timeout =
        node.number("pose_timeout_ms", {1, 1e4}, options.pose_timeout * 1e3) * 1e-3;
    options.approach_speed = node.number("approach_speed", {1e-3, 10}, options.approach_speed);
    return std::make_unique<estimation::PoseDriven>(options);
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

}  // namespace palpate::component
