#include "rt/registry/published_control_registry.hpp"

#include <functional>
#include <map>

#include "core/elasticity/comparison/as_rigid_as_possible.hpp"
#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "core/math/constants.hpp"
#include "core/published_control/broyden_update.hpp"
#include "core/published_control/chain_plan.hpp"
#include "core/published_control/constant_jacobian.hpp"
#include "core/published_control/difference_jacobian.hpp"
#include "core/published_control/diminishing_rigidity.hpp"
#include "core/published_control/factored_update.hpp"
#include "core/published_control/fourier_view.hpp"
#include "core/published_control/gaussian_process.hpp"
#include "core/published_control/gradient_update.hpp"
#include "core/published_control/learning_jacobian.hpp"
#include "core/published_control/open_loop.hpp"
#include "core/published_control/reach_then_deform.hpp"
#include "core/published_control/two_camera_view.hpp"
#include "core/published_control/weighted_least_squares_update.hpp"

namespace palpate::registry {
namespace {

using Provider = std::unique_ptr<control::JacobianProvider>;

using math::kDegree;

/// Inputs of a factory function.
struct Wanted {
  const config::Node& node;
  const Context& context;
  shape::Feature& feature;
};

published_control::ProbeOptions read_probes(const config::Node& control) {
  const config::Node node =
      control.child_or_empty({"probes", "", "motions that try each direction first"});
  published_control::ProbeOptions probes;
  probes.distance =
      node.number({"distance_mm", "mm", "of a probe"}, {0.1, 100}, probes.distance * 1e3) * 1e-3;
  probes.angle =
      node.number({"angle_deg", "degrees", "of a probe"}, {0.1, 45}, probes.angle / kDegree) *
      kDegree;
  probes.move = node.number({"move", "s", "of a probe, each way"}, {0.05, 10}, probes.move);
  probes.settle = node.number({"settle", "s", "of rest after a probe"}, {0, 10}, probes.settle);
  return probes;
}

published_control::LearningOptions read_learning(const config::Node& node) {
  published_control::LearningOptions options;
  options.probes = read_probes(node);
  options.period =
      node.number({"period_ms", "ms", "between two updates"}, {0, 1e4}, options.period * 1e3) *
      1e-3;
  options.least_motion = node.number({"least_motion_mm", "mm", "of the hand, that an update takes"},
                                     {1e-3, 100}, options.least_motion * 1e3) *
                         1e-3;
  options.length = node.number(
      {"rotation_length", "m", "a rotation by 1 rad weighs as much as this displacement"},
      {1e-3, 10}, options.length);
  return options;
}

std::unique_ptr<published_control::FeatureView> make_fourier_view(const config::Node& node) {
  published_control::FourierView::Options options;
  options.harmonics = node.integer("harmonics", {0, 15}, options.harmonics);
  options.closed = node.flag("closed", options.closed);
  return std::make_unique<published_control::FourierView>(options);
}

std::unique_ptr<published_control::FeatureView> make_two_camera_view(const Wanted& wanted) {
  published_control::TwoCameraView::Options options;
  // Both cameras point at the centre of the object: from the side, and from above.
  const Eigen::Matrix3Xd& nodes = wanted.context.object->body.mesh.nodes;
  options.target_O = 0.5 * (nodes.rowwise().minCoeff() + nodes.rowwise().maxCoeff());
  options.eyes_O[0] = options.target_O + Eigen::Vector3d(0, -1, 0.4);
  options.eyes_O[1] = options.target_O + Eigen::Vector3d(0, 0.5, 1.1);
  options.focal = wanted.node.number({"focal_px", "", "focal length of the two cameras, pixels"},
                                     {10, 1e5}, options.focal);
  return std::make_unique<published_control::TwoCameraView>(options);
}

std::unique_ptr<published_control::JacobianUpdate> make_gradient(const config::Node& node) {
  published_control::GradientUpdate::Options options;
  options.gain = node.number({"update_gain", "", "of the adaptation"}, {1e-4, 1.999}, options.gain);
  options.softness = node.number({"softness_mm", "mm", "motion that counts as half a motion"},
                                 {0, 100}, options.softness * 1e3) *
                     1e-3;
  return std::make_unique<published_control::GradientUpdate>(options);
}

std::unique_ptr<published_control::JacobianUpdate> make_broyden(const config::Node& node) {
  return std::make_unique<published_control::BroydenUpdate>(
      node.number({"update_gain", "", "of the adaptation"}, {1e-4, 1}, 0.5));
}

std::unique_ptr<published_control::JacobianUpdate> make_window(const config::Node& node) {
  published_control::WeightedLeastSquaresUpdate::Options options;
  options.window = node.integer({"window", "", "samples that the Jacobian is fitted to"}, {6, 500},
                                options.window);
  options.forgetting = node.number({"forgetting", "", "weight of a sample against the next"},
                                   {0.1, 1}, options.forgetting);
  options.confidence = node.number({"confidence", "", "least eigenvalue of the samples, relative"},
                                   {1e-6, 0.999}, options.confidence);
  return std::make_unique<published_control::WeightedLeastSquaresUpdate>(options);
}

Provider learning(const Wanted& wanted, std::unique_ptr<published_control::FeatureView> view,
                  std::unique_ptr<published_control::JacobianUpdate> update) {
  return std::make_unique<published_control::LearningJacobian>(
      read_learning(wanted.node), std::move(view), std::move(update), wanted.feature);
}

std::unique_ptr<published_control::FeatureView> plain() {
  return std::make_unique<published_control::PlainView>();
}

Provider make_diminishing(const Wanted& wanted, bool directional) {
  published_control::DiminishingRigidityOptions options;
  options.translation = wanted.node.number(
      {"rigidity", "", "how soon influence fades with distance, or how stiff a match is"}, {0, 1e3},
      options.translation);
  options.rotation = wanted.node.number(
      {"rotation_rigidity", "1/m", "how soon the influence of a rotation fades with distance"},
      {0, 1e3}, options.rotation);
  if (directional)
    options.push = wanted.node.number(
        {"push_rigidity", "1/m", "how soon the influence of a push fades with distance"},
        {1e-3, 1e3}, 8);
  return std::make_unique<published_control::DiminishingRigidity>(options,
                                                                  wanted.context.object->body, 0);
}

Provider make_as_rigid_as_possible(const Wanted& wanted) {
  return std::make_unique<published_control::DifferenceJacobian>(
      published_control::DifferenceJacobian::Options{}, wanted.context.object->body, 0,
      [](const elasticity::Body& body) {
        return std::make_unique<elasticity::AsRigidAsPossible>(body);
      });
}

Provider make_mass_spring(const Wanted& wanted) {
  published_control::DifferenceJacobian::Options options;
  options.dt = 10;  // suppresses inertia and damping
  return std::make_unique<published_control::DifferenceJacobian>(
      options, wanted.context.object->body, 0, [](const elasticity::Body& body) {
        elasticity::MassSpringOptions springs;
        springs.iterations = 2;
        springs.cg_iterations = 60;
        return std::make_unique<elasticity::MassSpringModel>(body, springs);
      });
}

Provider make_gaussian_process(const Wanted& wanted) {
  const config::Node& node = wanted.node;
  const published_control::LearningOptions learning = read_learning(node);
  published_control::GaussianProcess::Options options;
  options.probes = learning.probes;
  options.period = learning.period;
  options.least_motion = learning.least_motion;
  options.length = learning.length;
  options.reach =
      node.number({"reach", "m", "over which motions are alike"}, {1e-2, 100}, options.reach);
  options.noise =
      node.number({"process_noise", "", "of the regression"}, {1e-4, 10}, options.noise);
  options.samples = node.integer({"samples", "", "that are kept"}, {6, 80}, options.samples);
  options.gain = node.number("gain", {1e-3, 50}, options.gain);
  options.linear_speed = node.number("linear_speed", {1e-4, 10}, options.linear_speed);
  options.angular_speed = node.number("angular_speed", {1e-4, 10}, options.angular_speed);
  options.dead_band = node.number("dead_band_mm", {0, 1000}, options.dead_band * 1e3) * 1e-3;
  return std::make_unique<published_control::GaussianProcess>(options, wanted.feature);
}

/// Value of the feature on the rest shape moved by key `goal`.
Eigen::VectorXd read_goal(const Wanted& wanted) {
  const config::Node goal = wanted.node.child(
      {"goal", "", "where the feature shall be, for a plan that is made at the start"});
  shape::Feature& feature = wanted.feature;
  Eigen::VectorXd value(feature.value_count());
  feature.evaluate(wanted.context.object->body.mesh.nodes, value);
  if (goal.has("values")) {
    const std::vector<double> values =
        goal.numbers({"values", "", "of the feature itself"}, feature.value_count(), {-100, 100});
    return Eigen::Map<const Eigen::VectorXd>(values.data(), feature.value_count());
  }
  published_control::check_points(feature);
  const Eigen::Vector3d displacement =
      goal.vector3({"displacement", "m", "of every point of the feature from rest, in O"}, {-1, 1});
  return value + displacement.replicate(feature.value_count() / 3, 1);
}

published_control::OpenLoop::Options read_open_loop(const config::Node& node) {
  published_control::OpenLoop::Options options;
  options.gain = node.number("gain", {1e-3, 50}, options.gain);
  options.linear_speed = node.number("linear_speed", {1e-4, 10}, options.linear_speed);
  options.angular_speed = node.number("angular_speed", {1e-4, 10}, options.angular_speed);
  options.filter =
      node.number({"filter", "s", "time constant of the plan"}, {1e-3, 100}, options.filter);
  return options;
}

Provider make_open_loop(const Wanted& wanted, bool by_force) {
  published_control::OpenLoop::Options options = read_open_loop(wanted.node);
  options.by_force = by_force;
  return std::make_unique<published_control::OpenLoop>(
      options, published_control::solve_inverse(wanted.context.object->body, 0, wanted.feature,
                                                read_goal(wanted)));
}

Provider make_rheological_chain(const Wanted& wanted) {
  const config::Node& node = wanted.node;
  const published_control::OpenLoop::Options options = read_open_loop(node);
  published_control::ChainPlanOptions plan;
  plan.linear_speed = options.linear_speed;
  plan.chain.masses = node.integer({"masses", "", "of the chain"}, {6, 60}, plan.chain.masses);
  plan.chain.relaxation =
      node.number({"relaxation", "", "stiffness that creeps away, over that which stays"}, {0, 100},
                  plan.chain.relaxation);
  plan.chain.relaxation_time = node.number({"relaxation_time", "s", "in which it creeps away"},
                                           {1e-3, 1e6}, plan.chain.relaxation_time);
  plan.until = node.number({"until", "s", "when the target shall have been crept to"}, {0.5, 1e4},
                           plan.until);
  return std::make_unique<published_control::OpenLoop>(
      options, published_control::plan_with_chain(wanted.context.object->body, 0, wanted.feature,
                                                  read_goal(wanted), plan));
}

Provider make_reach_then_deform(const Wanted& wanted) {
  const config::Node& node = wanted.node;
  published_control::ReachThenDeform::Options options;
  if (node.has("reach")) {
    const config::Node reach = node.child(
        {"reach", "", "region that a fingertip reaches first; absent: the object is in the hand"});
    published_control::ReachThenDeform::Region region;
    region.tip_G = reach.vector3({"tip", "m", "of the fingertip, in G"}, {-1, 1});
    region.place_O = reach.vector3({"place", "m", "where it shall be, in O"}, {-10, 10});
    region.radius = reach.number({"radius", "m", "of the region"}, {1e-3, 1}, region.radius);
    options.region = region;
  }
  options.gain = node.number("gain", {1e-3, 50}, options.gain);
  options.linear_speed = node.number("linear_speed", {1e-4, 10}, options.linear_speed);
  options.update_gain =
      node.number({"update_gain", "", "of the adaptation"}, {1e-4, 1.999}, options.update_gain);
  options.softness = node.number({"softness_mm", "mm", "motion that counts as half a motion"},
                                 {1e-3, 100}, options.softness * 1e3) *
                     1e-3;
  options.dead_band = node.number("dead_band_mm", {0, 1000}, options.dead_band * 1e3) * 1e-3;
  return std::make_unique<published_control::ReachThenDeform>(options, wanted.feature);
}

using Maker = std::function<Provider(const Wanted&)>;

const std::map<std::string, Maker>& makers() {
  static const std::map<std::string, Maker> known = {
      {"adaptive_deformation",
       [](const Wanted& w) { return learning(w, plain(), make_gradient(w.node)); }},
      {"as_rigid_as_possible", make_as_rigid_as_possible},
      {"broyden", [](const Wanted& w) { return learning(w, plain(), make_broyden(w.node)); }},
      {"constant",
       [](const Wanted& w) -> Provider {
         return std::make_unique<published_control::ConstantJacobian>(
             control::FemJacobian::Options{}, w.feature);
       }},
      {"diminishing_rigidity", [](const Wanted& w) { return make_diminishing(w, false); }},
      {"directional_rigidity", [](const Wanted& w) { return make_diminishing(w, true); }},
      {"fourier_contour",
       [](const Wanted& w) {
         return learning(w, make_fourier_view(w.node), make_broyden(w.node));
       }},
      {"factored",
       [](const Wanted& w) {
         return learning(w, make_two_camera_view(w),
                         std::make_unique<published_control::FactoredUpdate>(w.node.number(
                             {"update_gain", "", "of the adaptation"}, {1e-4, 1}, 0.5)));
       }},
      {"gaussian_process", make_gaussian_process},
      {"inverse_elements_displacement", [](const Wanted& w) { return make_open_loop(w, false); }},
      {"inverse_elements_force", [](const Wanted& w) { return make_open_loop(w, true); }},
      {"mass_spring", make_mass_spring},
      {"multi_view",
       [](const Wanted& w) { return learning(w, make_two_camera_view(w), make_gradient(w.node)); }},
      {"reach_then_deform", make_reach_then_deform},
      {"rheological_chain", make_rheological_chain},
      {"weighted_least_squares",
       [](const Wanted& w) { return learning(w, plain(), make_window(w.node)); }},
  };
  return known;
}

}  // namespace

const std::vector<std::string>& published_providers() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& [name, maker] : makers()) list.push_back(name);
    return list;
  }();
  return names;
}

Provider make_published_provider(const std::string& name, const config::Node& node,
                                 const Context& context, shape::Feature& feature) {
  if (read_moving_arms(node, context) != MovingArms::kFirst)
    node.fail("provider", name + " moves the first arm only; see moves");
  if (context.object->body.grasps.empty())
    node.fail("provider", name + " needs an object that a hand holds: object.grasp_box");
  if (read_commands_joints(node, context))
    node.fail("provider", name + " moves the hand by twists; see command");
  try {
    return makers().at(name)({node, context, feature});
  } catch (const std::invalid_argument& error) {
    node.fail("provider", error.what());
  }
}

}  // namespace palpate::registry
