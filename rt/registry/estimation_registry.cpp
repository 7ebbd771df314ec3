#include "core/estimation/fingertip_driven.hpp"
#include "core/estimation/force_driven.hpp"
#include "core/estimation/pose_driven.hpp"
#include "core/estimation/pose_wrench_filter.hpp"
#include "core/estimation/wrench_driven.hpp"
#include "rt/plugin/built_in_names.hpp"
#include "rt/registry/plugin_registry.hpp"

namespace palpate::registry {
namespace {

std::unique_ptr<estimation::Estimator> make_force_driven(const config::Node& node,
                                                         const Context& context) {
  using estimation::ForceDriven;
  ForceDriven::Options options;
  const std::string filters =
      node.choice({"filters", "", "launch file of the thesis whose filters are taken"},
                  {"control", "sensing"}, "control");
  if (filters == "sensing") options = ForceDriven::Options::sensing_launch();
  options.variant =
      node.choice({"variant", "", "repaired keeps torque and gravity; as_released is the thesis"},
                  {"as_released", "repaired"}, "repaired") == "repaired"
          ? ForceDriven::Variant::kRepaired
          : ForceDriven::Variant::kAsReleased;
  options.fade = node.number({"fade_ms", "ms", "repaired: from the last load of a contact to none"},
                             {1, 1e4}, options.fade * 1e3) *
                 1e-3;
  options.average = node.number({"average_ms", "ms", "as released: moving average of the force"},
                                {0, 1e4}, options.average * 1e3) *
                    1e-3;
  options.delay = node.number({"delay_ms", "ms", "as released: that the force is held back"},
                              {0, 1e4}, options.delay * 1e3) *
                  1e-3;
  options.period = context.period;
  return std::make_unique<ForceDriven>(context.object->body, options);
}

std::unique_ptr<estimation::Estimator> make_fingertip_driven(const config::Node& node,
                                                             const Context& context) {
  using estimation::FingertipDriven;
  FingertipDriven::Options options;
  options.skin_stiffness =
      node.number({"skin_stiffness", "N/m", "of a fingertip"}, {1, 1e7}, options.skin_stiffness);
  options.friction = node.number({"friction", "", "of Coulomb, between fingertip and object"},
                                 {0.01, 10}, options.friction);
  options.slide = node.number({"slide", "m", "that a sliding touch lags behind before it is moved"},
                              {1e-5, 0.1}, options.slide);
  options.patience =
      node.number({"patience_ms", "ms", "without a contact, until the touch is over"}, {1, 1e4},
                  options.patience * 1e3) *
      1e-3;
  options.approach_speed = node.number(
      {"approach_speed", "m/s", "of held or touched material towards where it shall be, at most"},
      {1e-3, 10}, options.approach_speed);
  return std::make_unique<FingertipDriven>(context.object->body, context.object->surface, options);
}

std::unique_ptr<estimation::Estimator> make_wrench_driven(const config::Node& node,
                                                          const Context& context) {
  using estimation::WrenchDriven;
  WrenchDriven::Options options;
  options.time_constant =
      node.number({"time_constant_ms", "ms", "in which the grasp follows what the wrench says"},
                  {1, 1e5}, options.time_constant * 1e3) *
      1e-3;
  options.average =
      node.number({"average_ms", "ms", "time constant of the filter of the measured wrench"},
                  {0.1, 1e4}, options.average * 1e3) *
      1e-3;
  options.least_stiffness =
      node.number({"least_stiffness", "N/m", "below which the wrench tells nothing of a direction"},
                  {1e-6, 1e6}, options.least_stiffness);
  options.wrench_timeout =
      node.number({"wrench_timeout_ms", "ms", "without a new wrench, until it counts as stale"},
                  {1, 1e4}, options.wrench_timeout * 1e3) *
      1e-3;
  options.speed = node.number(
      {"approach_speed", "m/s", "of held or touched material towards where it shall be, at most"},
      {1e-3, 10}, options.speed);
  return std::make_unique<WrenchDriven>(context.object->body, options);
}

estimation::HandFollower::Options read_hand(const config::Node& node) {
  estimation::HandFollower::Options options;
  options.pose_timeout =
      node.number({"pose_timeout_ms", "ms", "without a new pose, until it counts as stale"},
                  {1, 1e4}, options.pose_timeout * 1e3) *
      1e-3;
  options.approach_speed = node.number(
      {"approach_speed", "m/s", "of held or touched material towards where it shall be, at most"},
      {1e-3, 10}, options.approach_speed);
  return options;
}

/// Options of shape observations, if configured.
void read_sight(const config::Node& node, estimation::PoseWrenchFilter::Options& options) {
  estimation::SurfaceFit::Options& sight = options.sight;
  sight.lag =
      node.number({"observation_lag_ms", "ms", "from when points are seen until they arrive"},
                  {0, 250}, sight.lag * 1e3) *
      1e-3;
  sight.lag_deviation = node.number({"observation_lag_deviation_ms", "ms",
                                     "uncertainty of that: what moves is seen less exactly"},
                                    {0.01, 250}, sight.lag_deviation * 1e3) *
                        1e-3;
  sight.surface = node.number(
      {"surface_deviation", "m",
       "that mesh and calibration may be wrong by at a place, the same for all points near it"},
      {0, 0.1}, sight.surface);
  sight.correlation =
      node.number({"surface_correlation_s", "s", "for which that error is the same"}, {1e-3, 60},
                  sight.correlation);
  sight.gate = node.number({"observation_gate", "deviations",
                            "beyond which a point is of something else: a hand, a table"},
                           {1, 100}, sight.gate);
  sight.reach =
      node.number({"observation_reach", "m", "beyond which it is, whatever else is uncertain"},
                  {1e-4, 1}, sight.reach);
  sight.points_per_tick =
      node.integer({"observation_points_per_tick", "", "points taken in a cycle"}, {1, 256},
                   sight.points_per_tick);
  options.shape =
      node.number({"shape_deviation", "m", "prior of what each virtual load moves the shape by"},
                  {1e-6, 1}, options.shape);
  options.fade =
      node.number({"observation_fade_ms", "ms", "in which what was seen comes into the shape"},
                  {1, 1e4}, options.fade * 1e3) *
      1e-3;
  options.filter.load_memory =
      node.number({"shape_memory_s", "s", "in which virtual loads wander by their prior deviation"},
                  {0.1, 1e6}, options.filter.load_memory);
}

std::unique_ptr<estimation::Estimator> make_pose_wrench_filter(const config::Node& node,
                                                               const Context& context) {
  using estimation::PoseWrenchFilter;
  PoseWrenchFilter::Options options;
  options.hand = read_hand(node);
  estimation::WrenchFilter::Options& prior = options.filter;
  prior.position = node.number(
      {"pose_position_deviation", "m", "prior deviation of each axis of the offset of a grasp"},
      {1e-6, 0.1}, prior.position);
  prior.rotation = node.number(
      {"pose_rotation_deviation", "rad", "prior deviation of each axis of its rotation"}, {1e-6, 1},
      prior.rotation);
  prior.log_young = node.number(
      {"log_young_modulus_deviation", "", "prior deviation of log E; 0.5 is a factor of 1.65"},
      {1e-3, 3}, prior.log_young);
  prior.bias_force =
      node.number({"bias_force_deviation", "N", "prior deviation of the bias of the force"},
                  {1e-6, 100}, prior.bias_force);
  prior.bias_torque =
      node.number({"bias_torque_deviation", "N m", "prior deviation of the bias of the torque"},
                  {1e-7, 10}, prior.bias_torque);
  prior.memory =
      node.number({"memory_s", "s", "in which what is learned wanders by its prior deviation"},
                  {0.1, 1e6}, prior.memory);
  options.period =
      node.number({"wrench_period_ms", "ms", "between two wrenches that the filter takes"},
                  {0.1, 1e3}, options.period * 1e3) *
      1e-3;
  options.force =
      node.number({"force_deviation", "N", "deviation of the force of a wrench that is taken"},
                  {1e-5, 10}, options.force);
  options.torque = node.number({"torque_deviation", "N m", "deviation of its torque"}, {1e-6, 1},
                               options.torque);
  options.relative = node.number(
      {"relative_error", "", "share of the predicted wrench that the model may be wrong by"},
      {0, 1}, options.relative);
  options.lag = node.number({"wrench_lag_ms", "ms", "of the wrench behind the pose"}, {0.01, 1e3},
                            options.lag * 1e3) *
                1e-3;
  options.lag_deviation =
      node.number({"wrench_lag_deviation_ms", "ms",
                   "uncertainty of that: the wrench of a moving hand counts less"},
                  {0.01, 1e3}, options.lag_deviation * 1e3) *
      1e-3;
  options.payload_error = node.number(
      {"payload_error", "kg",
       "of the hand that the sensor's model may have wrong, or late: the wrench of a hand that "
       "accelerates counts less"},
      {0, 1000}, options.payload_error);
  options.contacts =
      node.flag({"unknown_contacts", "", "whether pushes that nothing measures are looked for"},
                options.contacts);
  options.gate = node.number(
      {"innovation_gate", "", "normalised square of the innovation of a hand that is not believed"},
      {6, 1e6}, options.gate);
  options.search.spacing =
      node.number({"contact_spacing", "m", "at most, of the places that are looked at"}, {1e-3, 1},
                  options.search.spacing);
  options.search.friction =
      node.number({"contact_friction", "",
                   "the force of such a push lies within this cone about the inward normal"},
                  {0.01, 10}, options.search.friction);
  read_sight(node, options);
  return std::make_unique<PoseWrenchFilter>(context.object->body, context.object->surface, options);
}

}  // namespace

std::unique_ptr<estimation::Estimator> make_estimator(const config::Node& node,
                                                      const Context& context) {
  const auto& plugins = plugins_of(context).estimators;
  const std::string name = node.choice(
      {"component", "",
       "what drives the shape: the pose of the hand, the wrench, both, forces or fingertips"},
      plugin::with_plugins(plugin::kEstimators, plugins));
  if (const auto* entry = plugin::find_plugin(plugins, name))
    return make_plugin(*entry, node, context);
  try {
    if (name == "force_driven") return make_force_driven(node, context);
    if (name == "wrench_driven") return make_wrench_driven(node, context);
    if (name == "pose_wrench_filter") return make_pose_wrench_filter(node, context);
    if (name == "fingertip_driven") return make_fingertip_driven(node, context);
    estimation::PoseDriven::Options options;
    options.hand = read_hand(node);
    return std::make_unique<estimation::PoseDriven>(options);
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

}  // namespace palpate::registry
