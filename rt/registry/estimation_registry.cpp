#include "core/estimation/fingertip_driven.hpp"
#include "core/estimation/force_driven.hpp"
#include "core/estimation/pose_driven.hpp"
#include "core/estimation/pose_wrench_filter.hpp"
#include "core/estimation/wrench_driven.hpp"
#include "rt/registry/slot.hpp"

namespace palpate::registry {
namespace {

using config::OptionTable;
using estimation::FingertipDriven;
using estimation::ForceDriven;
using estimation::PoseDriven;
using estimation::PoseWrenchFilter;
using estimation::WrenchDriven;

template <class Options>
OptionTable<Options> approach_speed(double Options::*speed) {
  return OptionTable<Options>().number(
      "approach_speed", "m/s",
      "Largest speed of held or touched material towards its target position", {1e-3, 10}, speed);
}

OptionTable<estimation::HandFollower::Options> hand_options() {
  using Options = estimation::HandFollower::Options;
  return OptionTable<Options>()
      .number("pose_timeout_ms", "ms", "Time without a new pose after which the pose is stale",
              {1, 1e4}, &Options::pose_timeout, 1e-3)
      .part(approach_speed(&Options::approach_speed));
}

OptionTable<ForceDriven::Options> force_driven_options(const ForceDriven::Options& defaults) {
  using Options = ForceDriven::Options;
  return OptionTable<Options>(defaults)
      .choice<ForceDriven::Variant>(
          "variant",
          "Variant of the method; repaired keeps torque and gravity, as_released is the thesis",
          {{"as_released", ForceDriven::Variant::kAsReleased},
           {"repaired", ForceDriven::Variant::kRepaired}},
          &Options::variant)
      .number("fade_ms", "ms",
              "Time constant of the fade from the last load of a contact to none; variant repaired",
              {1, 1e4}, &Options::fade, 1e-3)
      .number("average_ms", "ms",
              "Duration of the moving average of the force; variant as_released", {0, 1e4},
              &Options::average, 1e-3)
      .number("delay_ms", "ms", "Delay of the force; variant as_released", {0, 1e4},
              &Options::delay, 1e-3);
}

std::unique_ptr<estimation::Estimator> make_force_driven(const config::Node& node,
                                                         const Context& context) {
  const std::string filters =
      node.choice({"filters", "", "Launch file of the thesis that provides the default filters"},
                  {"control", "sensing"}, "control");
  ForceDriven::Options options = node.read(force_driven_options(
      filters == "sensing" ? ForceDriven::Options::sensing_launch() : ForceDriven::Options()));
  options.period = context.period;
  return std::make_unique<ForceDriven>(context.object->body, options);
}

OptionTable<FingertipDriven::Options> fingertip_driven_options() {
  using Options = FingertipDriven::Options;
  return OptionTable<Options>()
      .number("skin_stiffness", "N/m", "Stiffness of a fingertip's skin", {1, 1e7},
              &Options::skin_stiffness)
      .number("friction", "", "Coulomb friction coefficient between fingertip and object",
              {0.01, 10}, &Options::friction)
      .number("slide", "m",
              "Lag of a sliding contact behind its fingertip at which the contact point is moved",
              {1e-5, 0.1}, &Options::slide)
      .number("contact_timeout_ms", "ms",
              "Time without a contact message after which a contact has ended", {1, 1e4},
              &Options::patience, 1e-3)
      .alias("patience_ms")
      .part(approach_speed(&Options::approach_speed));
}

OptionTable<WrenchDriven::Options> wrench_driven_options() {
  using Options = WrenchDriven::Options;
  return OptionTable<Options>()
      .number("time_constant_ms", "ms",
              "Time constant with which the grasp follows the pose that the wrench implies",
              {1, 1e5}, &Options::time_constant, 1e-3)
      .number("average_ms", "ms", "Time constant of the filter of the measured wrench", {0.1, 1e4},
              &Options::average, 1e-3)
      .number("least_stiffness", "N/m",
              "Stiffness below which the wrench does not determine a direction", {1e-6, 1e6},
              &Options::least_stiffness)
      .number("wrench_timeout_ms", "ms",
              "Time without a new wrench after which the wrench is stale", {1, 1e4},
              &Options::wrench_timeout, 1e-3)
      .part(approach_speed(&Options::speed));
}

OptionTable<estimation::WrenchFilter::Options> wrench_filter_options() {
  using Options = estimation::WrenchFilter::Options;
  return OptionTable<Options>()
      .number("pose_position_deviation", "m",
              "Prior standard deviation of each axis of the offset of a grasp", {1e-6, 0.1},
              &Options::position)
      .number("pose_rotation_deviation", "rad",
              "Prior standard deviation of each axis of the rotation of a grasp", {1e-6, 1},
              &Options::rotation)
      .number("log_young_modulus_deviation", "",
              "Prior standard deviation of log E; 0.5 is a factor of 1.65", {1e-3, 3},
              &Options::log_young)
      .number("bias_force_deviation", "N", "Prior standard deviation of the bias of the force",
              {1e-6, 100}, &Options::bias_force)
      .number("bias_torque_deviation", "N m", "Prior standard deviation of the bias of the torque",
              {1e-7, 10}, &Options::bias_torque)
      .number("memory_s", "s",
              "Time in which estimated parameters drift by their prior standard deviation",
              {0.1, 1e6}, &Options::memory)
      .number("shape_memory_s", "s",
              "Time in which virtual loads drift by their prior standard deviation", {0.1, 1e6},
              &Options::load_memory);
}

OptionTable<estimation::ContactSearch::Options> contact_search_options() {
  using Options = estimation::ContactSearch::Options;
  return OptionTable<Options>()
      .number("contact_spacing", "m",
              "Largest distance between candidate points of the search for unmeasured contacts",
              {1e-3, 1}, &Options::spacing)
      .number("contact_friction", "",
              "Tangent of the half angle of the cone about the inward normal that contains the "
              "force of an unmeasured contact",
              {0.01, 10}, &Options::friction);
}

OptionTable<estimation::SurfaceFit::Options> surface_fit_options() {
  using Options = estimation::SurfaceFit::Options;
  return OptionTable<Options>()
      .number("observation_lag_ms", "ms", "Latency from the acquisition of points to their arrival",
              {0, 250}, &Options::lag, 1e-3)
      .number("observation_lag_deviation_ms", "ms",
              "Standard deviation of that latency; reduces the weight of moving surfaces",
              {0.01, 250}, &Options::lag_deviation, 1e-3)
      .number("surface_deviation", "m",
              "Standard deviation of the local error of mesh and calibration, common to all "
              "neighbouring points",
              {0, 0.1}, &Options::surface)
      .number("surface_correlation_s", "s", "Correlation time of that error", {1e-3, 60},
              &Options::correlation)
      .number("observation_gate", "standard deviations",
              "Distance beyond which a point is attributed to another object, such as a hand",
              {1, 100}, &Options::gate)
      .number("observation_reach", "m",
              "Distance beyond which a point is attributed to another object, whatever the "
              "uncertainty",
              {1e-4, 1}, &Options::reach)
      .integer("observation_points_per_tick", "Number of points processed in a cycle", {1, 256},
               &Options::points_per_tick);
}

OptionTable<estimation::LearningGuard::Options> consistency_options() {
  using Options = estimation::LearningGuard::Options;
  return OptionTable<Options>()
      .flag(
          "consistency_test",
          "Test whether the wrenches contradict the model, and learn from them as the test allows; "
          "while they contradict it, the estimator is degraded and learns nothing. A lasting "
          "change keeps it so until the component is reset",
          &Options::enabled)
      .number("poisson_ratio_deviation", "",
              "Standard deviation of Poisson's ratio; for the test of the wrenches' consistency",
              {0, 0.5}, &Options::poisson)
      .number("density_error", "", "Relative standard deviation of the density; for the same test",
              {0, 1}, &Options::density)
      .number("stiffness_error", "",
              "Relative standard deviation of the stiffness in each direction, compared with the "
              "common factor, as by uneven stiffness and dimensions; for the same test",
              {0, 1}, &Options::stiffness_error)
      .number("pose_dependent_error", "",
              "Standard deviation, relative to the wrench, of the error of the predicted wrench "
              "that varies with the hand's pose; for the same test",
              {0, 1}, &Options::pose_error)
      .number("pose_dependent_position_error", "m",
              "Standard deviation of the part of the hand's position error that varies with its "
              "pose; for the same test",
              {0, 0.1}, &Options::position_error)
      .number("pose_dependent_rotation_error", "rad",
              "Standard deviation of the part of the hand's rotation error that varies with its "
              "pose; for the same test",
              {0, 1}, &Options::rotation_error)
      .number("false_alarms_per_hour", "1/h",
              "Rate of false alarms per hand of the test of the wrenches' consistency", {1e-3, 100},
              &Options::false_alarms);
}

OptionTable<estimation::NodeDeviations::Options> node_deviation_options() {
  using Options = estimation::NodeDeviations::Options;
  return OptionTable<Options>()
      .number(
          "clamp_deviation", "m",
          "Standard deviation of each axis of the object's position; for the reported deviations "
          "of the shape",
          {0, 0.1}, &Options::clamp)
      .number("shape_error", "",
              "Relative standard deviation of the displacement of nodes halfway between clamp and "
              "hand, by uneven stiffness and dimensions; for the reported deviations of the shape",
              {0, 1}, &Options::shape);
}

OptionTable<PoseWrenchFilter::Options> pose_wrench_filter_options() {
  using Options = PoseWrenchFilter::Options;
  return OptionTable<Options>()
      .part(hand_options(), &Options::hand)
      .part(wrench_filter_options(), &Options::filter)
      .number("wrench_period_ms", "ms", "Period of the wrench updates of the filter", {0.1, 1e3},
              &Options::period, 1e-3)
      .number("force_deviation", "N", "Standard deviation of the force of a wrench update",
              {1e-5, 10}, &Options::force)
      .number("torque_deviation", "N m", "Standard deviation of the torque of a wrench update",
              {1e-6, 1}, &Options::torque)
      .number("relative_error", "", "Relative model error of the predicted wrench", {0, 1},
              &Options::relative)
      .number("wrench_lag_ms", "ms", "Delay of the wrench relative to the pose", {0.01, 1e3},
              &Options::lag, 1e-3)
      .number("wrench_lag_deviation_ms", "ms",
              "Standard deviation of that delay; reduces the weight of wrenches of a moving hand",
              {0.01, 1e3}, &Options::lag_deviation, 1e-3)
      .number("payload_error", "kg",
              "Error of the hand's mass in the sensor's model; reduces the weight of wrenches of "
              "an accelerating hand",
              {0, 1000}, &Options::payload_error)
      .flag("unknown_contacts", "Search for contacts that no sensor measures", &Options::contacts)
      .number("innovation_gate", "",
              "Normalised square of the innovation of a hand above which it is rejected", {6, 1e6},
              &Options::gate)
      .part(consistency_options(), &Options::consistency)
      .part(node_deviation_options(), &Options::deviations)
      .part(contact_search_options(), &Options::search)
      .part(surface_fit_options(), &Options::observation)
      .number("shape_deviation", "m",
              "Prior standard deviation of the displacement by each virtual load", {1e-6, 1},
              &Options::shape)
      .number("observation_fade_ms", "ms",
              "Time over which corrections from observations are faded into the shape", {1, 1e4},
              &Options::fade, 1e-3);
}

std::unique_ptr<estimation::Estimator> make_pose_wrench_filter(
    const PoseWrenchFilter::Options& configured, const config::Node& /*node*/,
    const Context& context) {
  PoseWrenchFilter::Options options = configured;
  options.filter.obstacles = free_directions(context.object->obstacles);
  return std::make_unique<PoseWrenchFilter>(context.object->body, context.object->surface, options);
}

}  // namespace

std::unique_ptr<estimation::Estimator> make_estimator(const config::Node& node,
                                                      const Context& context) {
  static const auto slot =
      Slot<plugin::PluginEstimator>({"component", "", "Estimator that drives the shape"},
                                    &plugin::PluginRegistrar::estimators)
          .add("pose_driven", "Shape from the pose of the hand",
               OptionTable<PoseDriven::Options>().part(hand_options(), &PoseDriven::Options::hand),
               from_options<PoseDriven>())
          .add("force_driven", "Shape from measured contact forces", make_force_driven)
          .add("wrench_driven", "Shape from the wrench at the wrist", wrench_driven_options(),
               from_options<WrenchDriven>())
          .add("fingertip_driven", "Shape from the positions of touching fingertips",
               fingertip_driven_options(), from_options<FingertipDriven>())
          .add("pose_wrench_filter",
               "Shape, stiffness and contacts from pose, wrench and observed surface points",
               pose_wrench_filter_options(), make_pose_wrench_filter);
  return slot.make(node, context);
}

}  // namespace palpate::registry
