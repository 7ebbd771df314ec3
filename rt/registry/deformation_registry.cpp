#include <algorithm>

#include "core/elasticity/comparison/linear_model.hpp"
#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "core/elasticity/comparison/shape_matching_model.hpp"
#include "core/elasticity/comparison/thesis2018.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/math/blas.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/spin_team.hpp"
#include "rt/registry/slot.hpp"

#ifdef PALPATE_SUITESPARSE
#include "core/factor/cholmod/cholmod_factor.hpp"
#include "core/factor/cholmod/cholmod_orders.hpp"
#endif

namespace palpate::registry {
namespace {

using config::OptionTable;
using elasticity::MassSpringOptions;
using elasticity::ShapeMatchingOptions;
using Model = std::unique_ptr<elasticity::DeformationModel>;

template <class Options>
OptionTable<Options> tolerance() {
  return OptionTable<Options>().number(
      "tolerance", "N", "Largest unbalanced force of a node at which a step ends early", {1e-12, 1},
      &Options::tolerance);
}

#ifdef PALPATE_SUITESPARSE
constexpr factor::FactorMaker kDefaultFactor = factor::make_cholmod_factor;
const std::vector<std::pair<std::string, factor::FactorMaker>> kFactors{
    {"cholmod", factor::make_cholmod_factor}, {"own", factor::make_own_factor}};

/// Adds what else CHOLMOD contributes, whose BLAS is called from the threads of the background.
void complete_factor(const config::Node& node, elasticity::SolverOptions& options) {
  const std::string problem = math::problem_of(math::hold_blas_to_one_thread());
  if (options.make_factor != factor::make_cholmod_factor) return;
  if (!problem.empty()) node.fail("factor", problem + ", or allowed: own");
  options.orders = factor::cholmod_orders;
}
#else
constexpr factor::FactorMaker kDefaultFactor = factor::make_own_factor;
const std::vector<std::pair<std::string, factor::FactorMaker>> kFactors{
    {"own", factor::make_own_factor}};

void complete_factor(const config::Node&, elasticity::SolverOptions&) {}
#endif

OptionTable<elasticity::SolverOptions> solver_options() {
  using Options = elasticity::SolverOptions;
  Options defaults;
  defaults.make_factor = kDefaultFactor;
  return OptionTable<Options>(defaults)
      .integer("iterations", "Largest number of quasi-Newton corrections in a step", {1, 50},
               &Options::iterations)
      .part(tolerance<Options>())
      .number(
          "accuracy", "m",
          "Displacement of a node below which a further correction is omitted and the step ends",
          {0, 1e-3}, &Options::accuracy)
      .choice<elasticity::Precision>(
          "precision", "Precision of the arithmetic inside elements",
          {{"double", elasticity::Precision::kDouble}, {"single", elasticity::Precision::kSingle}},
          &Options::precision)
      .choice<factor::PanelPrecision>(
          "panels", "Precision of the stored factor",
          {{"single", factor::PanelPrecision::kSingle}, {"half", factor::PanelPrecision::kHalf}},
          &Options::panels)
      .choice<factor::FactorMaker>(
          "factor",
          "Who computes the factor in the background; cholmod: L L^T by CHOLMOD, or the own "
          "L D L^T where a matrix is not positive definite; own: always the latter",
          kFactors, &Options::make_factor)
      .integer("refine",
               "Number of columns of the sensitivity that a quasi-static step corrects as well; "
               "6: all once, 12: all twice",
               {0, 12}, &Options::refine)
      .flag("confirm", "Evaluation of the forces after a correction that is expected to end a step",
            &Options::confirm)
      // A step that exceeds its time budget keeps the last valid shape, which is reported. Because
      // the timing depends on the machine, runs with a budget are not bitwise reproducible.
      .number("budget", "s",
              "Duration after which a step keeps the last valid shape, which is then reported as "
              "old; 0: unlimited",
              {0, 1}, &Options::budget);
}

/// The other threads should have the loop's priority. If it is rejected, so is the loop's, and the
/// daemon reports it.
OptionTable<loop::SpinTeamOptions> team_options() {
  loop::SpinTeamOptions alone;
  alone.size = 1;
  return OptionTable<loop::SpinTeamOptions>(alone)
      .integer("threads",
               "Number of threads that share a step, including the loop's; each needs a processor",
               {1, 8}, &loop::SpinTeamOptions::size)
      .integer("threads_fifo_priority",
               "SCHED_FIFO priority of the other threads; should equal the loop's", {0, 98},
               &loop::SpinTeamOptions::fifo_priority);
}

/// Models without contact must not ignore the obstacles of the configuration.
void check_no_obstacles(const config::Node& node, const std::string& key, const Context& context) {
  if (!context.object->obstacles.empty())
    node.fail(key,
              "does not know contact with obstacles; allowed with obstacles: component "
              "corotational_quasistatic, hyperelastic, or corotational_dynamic with integrator "
              "backward_euler");
}

/// Options of the incremental models.
elasticity::SolverOptions read_solver(const config::Node& node, const Context& context) {
  elasticity::SolverOptions options = node.read(solver_options());
  complete_factor(node, options);
  if (options.budget > 0)
    options.clock = [] { return 1e-9 * static_cast<double>(loop::monotonic_ns()); };
  options.time_step = context.period;
  for (const ConfiguredObstacle& obstacle : context.object->obstacles)
    options.contact.obstacles.push_back(obstacle.limited.body);
  // so that the estimator knows the distances of obstacles that may be touched in truth
  constexpr double kLongestReach = 0.02;  // m
  for (const collision::Obstacle& obstacle : options.contact.obstacles)
    options.contact.reach =
        std::max(options.contact.reach,
                 std::min(kLongestReach, 2 * obstacle.pose_deviation.head<3>().norm()));
  const loop::SpinTeamOptions team = node.read(team_options());
  if (team.size > 1) options.team = std::make_shared<loop::SpinTeam>(team);
  return options;
}

template <class Corotational>
Model make_corotational(const config::Node& node, const Context& context) {
  constexpr bool kDynamic = std::is_same_v<Corotational, elasticity::CorotationalDynamic>;
  elasticity::Body body = context.object->body;
  body.law.reset();
  const std::string integrator =
      node.choice({"integrator", "",
                   "Time integration; thesis2018: with the steps of the thesis' program, in "
                   "corotational_dynamic only"},
                  {"backward_euler", "thesis2018"}, "backward_euler");
  if (integrator == "thesis2018") {
    if (!kDynamic) node.fail("integrator", "thesis2018 needs component corotational_dynamic");
    check_no_obstacles(node, "integrator", context);
    return std::make_unique<elasticity::Thesis2018>(body);
  }
  return std::make_unique<Corotational>(std::move(body), read_solver(node, context));
}

Model make_hyperelastic(const config::Node& node, const Context& context) {
  const elasticity::Body& body = context.object->body;
  if (!body.law)
    node.fail("component",
              "hyperelastic needs object.material.model, one of the laws other than linear");
  if (node.flag({"inertia", "", "Motion with inertia and damping instead of equilibrium"}, false))
    return std::make_unique<elasticity::CorotationalDynamic>(body, read_solver(node, context));
  return std::make_unique<elasticity::CorotationalQuasistatic>(body, read_solver(node, context));
}

}  // namespace

Model make_deformation_model(const config::Node& node, const Context& context) {
  static const auto slot =
      Slot<plugin::PluginDeformationModel>({"component", "", "Model of the object's mechanics"},
                                           &plugin::PluginRegistrar::deformation_models)
          .add("corotational_quasistatic", "Co-rotational finite elements in static equilibrium",
               make_corotational<elasticity::CorotationalQuasistatic>)
          .add("corotational_dynamic", "Co-rotational finite elements with inertia and damping",
               make_corotational<elasticity::CorotationalDynamic>)
          .add("hyperelastic",
               "The same finite elements with the law of object.material.model, which holds at "
               "large strain",
               make_hyperelastic)
          .add("linear", "Linear finite elements, for comparison",
               [](const config::Node&, const Context& in) -> Model {
                 return std::make_unique<elasticity::LinearModel>(in.object->body);
               })
          .add("mass_spring", "Masses and springs, for comparison",
               OptionTable<MassSpringOptions>()
                   .integer("iterations", "Largest number of Newton corrections in a step", {1, 50},
                            &MassSpringOptions::iterations)
                   .part(tolerance<MassSpringOptions>())
                   .integer("cg_iterations",
                            "Largest number of conjugate gradient iterations in a correction",
                            {1, 10000}, &MassSpringOptions::cg_iterations),
               from_options<elasticity::MassSpringModel>())
          .add(
              "shape_matching", "Shape matching, for comparison",
              OptionTable<ShapeMatchingOptions>()
                  .integer("rings",
                           "Number of rings of edges around each node that its region covers",
                           {1, 5}, &ShapeMatchingOptions::rings)
                  .integer("max_substeps",
                           "Largest number of parts of a step; more parts allow a higher stiffness",
                           {1, 100}, &ShapeMatchingOptions::max_substeps),
              from_options<elasticity::ShapeMatchingModel>());
  const std::string component = slot.name(node, context);
  if (component != "hyperelastic" && component.rfind("corotational_", 0) != 0)
    check_no_obstacles(node, "component", context);
  return slot.make(node, context);
}

}  // namespace palpate::registry
