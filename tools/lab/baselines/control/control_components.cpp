#include <stdexcept>

#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "tools/lab/baselines/components.hpp"
#include "tools/lab/baselines/control/broyden_update.hpp"
#include "tools/lab/baselines/control/chain_plan.hpp"
#include "tools/lab/baselines/control/constant_jacobian.hpp"
#include "tools/lab/baselines/control/difference_jacobian.hpp"
#include "tools/lab/baselines/control/factored_update.hpp"
#include "tools/lab/baselines/control/fourier_view.hpp"
#include "tools/lab/baselines/control/provider_options.hpp"
#include "tools/lab/baselines/control/reach_then_deform.hpp"
#include "tools/lab/baselines/control/two_camera_view.hpp"
#include "tools/lab/baselines/deformation/as_rigid_as_possible.hpp"

namespace palpate::baselines {
namespace {

using plugin::PluginCell;
using Provider = std::unique_ptr<control::JacobianProvider>;
using View = std::unique_ptr<FeatureView>;
using Update = std::unique_ptr<JacobianUpdate>;

/// Adds a provider that `make(options, cell)` creates.
template <class Options, class Make>
void add(plugin::PluginRegistrar& registrar, const std::string& name,
         const config::OptionTable<Options>& table, Make make) {
  registrar.jacobian_providers.add(
      name, table, [make](const Options& options, const PluginCell& cell) -> Provider {
        if (cell.moved_grasp != 0 || cell.moved_grasps != 1)
          throw std::invalid_argument("moves the first arm only; see moves");
        if (cell.body->grasps.empty())
          throw std::invalid_argument("needs an object that a hand holds: object.grasp_box");
        if (cell.commands_joints)
          throw std::invalid_argument("moves the hand by twists; see command");
        return make(options, cell);
      });
}

/// Options of a learning provider, of its view and of its update.
template <class ViewOptions, class UpdateOptions>
struct Learning {
  LearningOptions learning;
  ViewOptions view;
  UpdateOptions update;
};
struct Nothing {};

/// Adds a LearningJacobian.
template <class ViewOptions, class UpdateOptions, class MakeView, class MakeUpdate>
void add_learning(plugin::PluginRegistrar& registrar, const std::string& name,
                  const config::OptionTable<ViewOptions>& view,
                  const config::OptionTable<UpdateOptions>& update, MakeView make_view,
                  MakeUpdate make_update) {
  using Options = Learning<ViewOptions, UpdateOptions>;
  add(registrar, name,
      config::OptionTable<Options>()
          .part(learning_table<LearningOptions>(), &Options::learning)
          .part(view, &Options::view)
          .part(update, &Options::update),
      [make_view, make_update](const Options& options, const PluginCell& cell) -> Provider {
        return std::make_unique<LearningJacobian>(options.learning, make_view(options.view, cell),
                                                  make_update(options.update), *cell.feature);
      });
}

View make_plain_view(const Nothing&, const PluginCell&) { return std::make_unique<PlainView>(); }

View make_fourier_view(const FourierView::Options& options, const PluginCell&) {
  return std::make_unique<FourierView>(options);
}

View make_two_camera_view(TwoCameraView::Options options, const PluginCell& cell) {
  // Both cameras point at the centre of the object: from the side, and from above.
  const Eigen::Matrix3Xd& nodes = cell.body->mesh.nodes;
  options.target_O = 0.5 * (nodes.rowwise().minCoeff() + nodes.rowwise().maxCoeff());
  options.eyes_O[0] = options.target_O + Eigen::Vector3d(0, -1, 0.4);
  options.eyes_O[1] = options.target_O + Eigen::Vector3d(0, 0.5, 1.1);
  return std::make_unique<TwoCameraView>(options);
}

template <class Method>
constexpr auto kUpdate =
    [](const auto& options) -> Update { return std::make_unique<Method>(options); };
template <class Method>
constexpr auto kGainUpdate =
    [](const UpdateGain& gain) -> Update { return std::make_unique<Method>(gain.value); };

void add_learning_providers(plugin::PluginRegistrar& registrar) {
  const config::OptionTable<Nothing> nothing;
  const auto fourier =
      config::OptionTable<FourierView::Options>()
          .integer("harmonics", "of the contour, each four numbers a plane", {0, 15},
                   &FourierView::Options::harmonics)
          .flag("closed", "whether the contour is closed", &FourierView::Options::closed);
  const auto cameras = config::OptionTable<TwoCameraView::Options>().number(
      "focal_px", "", "focal length of the two cameras, pixels", {10, 1e5},
      &TwoCameraView::Options::focal);
  add_learning(registrar, "adaptive_deformation", nothing, gradient_table(), make_plain_view,
               kUpdate<GradientUpdate>);
  add_learning(registrar, "broyden", nothing, update_gain_table(), make_plain_view,
               kGainUpdate<BroydenUpdate>);
  add_learning(registrar, "weighted_least_squares", nothing, window_table(), make_plain_view,
               kUpdate<WeightedLeastSquaresUpdate>);
  add_learning(registrar, "fourier_contour", fourier, update_gain_table(), make_fourier_view,
               kGainUpdate<BroydenUpdate>);
  add_learning(registrar, "factored", cameras, update_gain_table(), make_two_camera_view,
               kGainUpdate<FactoredUpdate>);
  add_learning(registrar, "multi_view", cameras, gradient_table(), make_two_camera_view,
               kUpdate<GradientUpdate>);
  add(registrar, "gaussian_process", gaussian_process_table(),
      [](const GaussianProcess::Options& options, const PluginCell& cell) -> Provider {
        return std::make_unique<GaussianProcess>(options, *cell.feature);
      });
}

Provider make_as_rigid_as_possible(const Nothing&, const PluginCell& cell) {
  return std::make_unique<DifferenceJacobian>(
      DifferenceJacobian::Options{}, *cell.body, 0,
      [](const elasticity::Body& body) { return std::make_unique<AsRigidAsPossible>(body); });
}

Provider make_mass_spring(const Nothing&, const PluginCell& cell) {
  DifferenceJacobian::Options options;
  options.dt = 10;  // suppresses inertia and damping
  return std::make_unique<DifferenceJacobian>(
      options, *cell.body, 0, [](const elasticity::Body& body) {
        elasticity::MassSpringOptions springs;
        springs.iterations = 2;
        springs.cg_iterations = 60;
        return std::make_unique<elasticity::MassSpringModel>(body, springs);
      });
}

Provider make_rigidity(const DiminishingRigidityOptions& options, const PluginCell& cell) {
  return std::make_unique<DiminishingRigidity>(options, *cell.body, 0);
}

void add_model_providers(plugin::PluginRegistrar& registrar) {
  const config::OptionTable<Nothing> nothing;
  add(registrar, "as_rigid_as_possible", nothing, make_as_rigid_as_possible);
  add(registrar, "mass_spring", nothing, make_mass_spring);
  add(registrar, "constant", nothing, [](const Nothing&, const PluginCell& cell) -> Provider {
    return std::make_unique<ConstantJacobian>(control::FemJacobian::Options{}, *cell.feature);
  });
  add(registrar, "diminishing_rigidity", rigidity_table(false), make_rigidity);
  add(registrar, "directional_rigidity", rigidity_table(true), make_rigidity);
}

/// Value of the feature on the rest shape moved by the goal.
Eigen::VectorXd value_of(const Goal& goal, const PluginCell& cell) {
  shape::Feature& feature = *cell.feature;
  Eigen::VectorXd value(feature.value_count());
  feature.evaluate(cell.body->mesh.nodes, value);
  if (!goal.values.empty()) {
    if (static_cast<int>(goal.values.size()) != feature.value_count())
      throw std::invalid_argument("goal.values has " + std::to_string(goal.values.size()) +
                                  " numbers; allowed: " + std::to_string(feature.value_count()));
    return Eigen::Map<const Eigen::VectorXd>(goal.values.data(), feature.value_count());
  }
  if (goal.displacement.size() != 3)
    throw std::invalid_argument("goal needs displacement, three numbers, or values");
  check_points(feature);
  return value + Eigen::Map<const Eigen::Vector3d>(goal.displacement.data())
                     .replicate(feature.value_count() / 3, 1);
}

struct Planned {
  OpenLoop::Options loop;
  Goal goal;
};

void add_inverse_elements(plugin::PluginRegistrar& registrar, const std::string& name,
                          bool by_force) {
  add(registrar, name,
      config::OptionTable<Planned>()
          .part(open_loop_table(), &Planned::loop)
          .part(goal_table(), &Planned::goal),
      [by_force](const Planned& planned, const PluginCell& cell) -> Provider {
        OpenLoop::Options options = planned.loop;
        options.by_force = by_force;
        return std::make_unique<OpenLoop>(
            options, solve_inverse(*cell.body, 0, *cell.feature, value_of(planned.goal, cell)));
      });
}

struct PlannedChain {
  Planned planned;
  ChainPlanOptions plan;
};

void add_rheological_chain(plugin::PluginRegistrar& registrar) {
  using Options = PlannedChain;
  add(registrar, "rheological_chain",
      config::OptionTable<Options>()
          .part(
              open_loop_table(), [](auto& o) -> auto& { return o.planned.loop; })
          .part(
              goal_table(), [](auto& o) -> auto& { return o.planned.goal; })
          .integer(
              "masses", "of the chain", {6, 60},
              [](auto& o) -> auto& { return o.plan.chain.masses; })
          .number(
              "relaxation", "", "stiffness that creeps away, over that which stays", {0, 100},
              [](auto& o) -> auto& { return o.plan.chain.relaxation; })
          .number(
              "relaxation_time", "s", "in which it creeps away", {1e-3, 1e6},
              [](auto& o) -> auto& { return o.plan.chain.relaxation_time; })
          .number(
              "until", "s", "by when the target is to be reached", {0.5, 1e4},
              [](auto& o) -> auto& { return o.plan.until; }),
      [](const Options& options, const PluginCell& cell) -> Provider {
        ChainPlanOptions plan = options.plan;
        plan.linear_speed = options.planned.loop.linear_speed;
        return std::make_unique<OpenLoop>(
            options.planned.loop, plan_with_chain(*cell.body, 0, *cell.feature,
                                                  value_of(options.planned.goal, cell), plan));
      });
}

struct Reaching {
  ReachThenDeform::Options options;
  std::vector<double> tip, place;  // m; empty: the object is in the hand
  double radius = ReachThenDeform::Region().radius;
};

Provider make_reach_then_deform(const Reaching& reaching, const PluginCell& cell) {
  ReachThenDeform::Options options = reaching.options;
  if (!reaching.tip.empty() || !reaching.place.empty()) {
    if (reaching.tip.size() != 3) throw std::invalid_argument("reach.tip must be three numbers");
    if (reaching.place.size() != 3)
      throw std::invalid_argument("reach.place must be three numbers");
    ReachThenDeform::Region region;
    region.tip_G = Eigen::Vector3d(reaching.tip.data());
    region.place_O = Eigen::Vector3d(reaching.place.data());
    region.radius = reaching.radius;
    options.region = region;
  }
  return std::make_unique<ReachThenDeform>(options, *cell.feature);
}

void add_reach_then_deform(plugin::PluginRegistrar& registrar) {
  add(registrar, "reach_then_deform",
      config::OptionTable<Reaching>()
          .numbers("reach.tip", "m",
                   "of the fingertip that reaches a region first, in G; absent: the object is in "
                   "the hand",
                   {-1, 1}, -1, &Reaching::tip)
          .numbers("reach.place", "m", "where it is to be, in O", {-10, 10}, -1, &Reaching::place)
          .number("reach.radius", "m", "of the region", {1e-3, 1}, &Reaching::radius)
          .number(
              "gain", "1/s", "share of the error that is made up for in a second", {1e-3, 50},
              [](auto& o) -> auto& { return o.options.gain; })
          .number(
              "linear_speed", "m/s", "largest of the origin of G", {1e-4, 10},
              [](auto& o) -> auto& { return o.options.linear_speed; })
          .number(
              "update_gain", "", "of the adaptation", {1e-4, 1.999},
              [](auto& o) -> auto& { return o.options.update_gain; })
          .number(
              "softness_mm", "mm", "motion that counts as half a motion", {1e-3, 100},
              [](auto& o) -> auto& { return o.options.softness; }, 1e-3)
          .number(
              "dead_band_mm", "mm", "error of positions within which the hand rests", {0, 1000},
              [](auto& o) -> auto& { return o.options.dead_band; }, 1e-3),
      make_reach_then_deform);
}

}  // namespace

void add_providers(plugin::PluginRegistrar& registrar) {
  add_learning_providers(registrar);
  add_model_providers(registrar);
  add_inverse_elements(registrar, "inverse_elements_displacement", false);
  add_inverse_elements(registrar, "inverse_elements_force", true);
  add_rheological_chain(registrar);
  add_reach_then_deform(registrar);
}

}  // namespace palpate::baselines
