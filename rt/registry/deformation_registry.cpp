#include "core/elasticity/comparison/linear_model.hpp"
#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "core/elasticity/comparison/shape_matching_model.hpp"
#include "core/elasticity/comparison/thesis2018.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/spin_team.hpp"
#include "rt/plugin/built_in_names.hpp"
#include "rt/registry/plugin_registry.hpp"

namespace palpate::registry {
namespace {

using Model = std::unique_ptr<elasticity::DeformationModel>;

/// `threads`: number of threads that share a step, including the loop's; null for one. The others
/// get `threads_fifo_priority`, which should equal the loop's. If it is rejected, so is the loop's,
/// and the daemon reports it.
std::shared_ptr<math::Team> make_team(const config::Node& node) {
  loop::SpinTeamOptions options;
  options.size = node.integer(
      {"threads", "", "that share a step, the one of the loop among them; each takes a processor"},
      {1, 8}, 1);
  options.fifo_priority = node.integer(
      {"threads_fifo_priority", "", "SCHED_FIFO priority of the others; best that of the loop"},
      {0, 98}, 0);
  if (options.size == 1) return nullptr;
  return std::make_shared<loop::SpinTeam>(options);
}

Model make_corotational(const config::Node& node, const std::string& name, const Context& context) {
  const std::string integrator = node.choice(
      {"integrator", "",
       "thesis2018 reproduces the printed figures of the thesis, in corotational_dynamic alone"},
      {"backward_euler", "thesis2018"}, "backward_euler");
  const elasticity::Body& body = context.object->body;
  if (integrator == "thesis2018") {
    if (name != "corotational_dynamic") {
      node.fail("integrator", "thesis2018 needs component corotational_dynamic");
    }
    return std::make_unique<elasticity::Thesis2018>(body);
  }
  elasticity::SolverOptions options;
  options.iterations =
      node.integer({"iterations", "", "quasi-Newton corrections in a step, at most"}, {1, 50},
                   options.iterations);
  options.tolerance = node.number(
      {"tolerance", "N", "largest force of a node out of balance at which a step ends early"},
      {1e-12, 1}, options.tolerance);
  options.accuracy = node.number(
      {"accuracy", "m", "a step also ends where the next correction would move no node further"},
      {0, 1e-3}, options.accuracy);
  options.precision = node.choice({"precision", "", "of the arithmetic inside elements"},
                                  {"double", "single"}, "double") == "single"
                          ? elasticity::Precision::kSingle
                          : elasticity::Precision::kDouble;
  options.panels =
      node.choice({"panels", "", "of the stored factor"}, {"single", "half"}, "single") == "half"
          ? factor::PanelPrecision::kHalf
          : factor::PanelPrecision::kSingle;
  options.refine = node.integer({"refine", "",
                                 "columns of the sensitivity that a quasi-static step corrects as "
                                 "well; 6: all once, 12: twice"},
                                {0, 12}, options.refine);
  options.confirm = node.flag(
      {"confirm", "",
       "whether forces are evaluated once more after a correction that is expected to end a step"},
      options.confirm);
  // A step that exceeds its time budget keeps the last valid shape, which is reported. Because the
  // timing depends on the machine, runs with a budget are not bitwise reproducible.
  options.budget = node.number(
      {"budget", "s", "after which a step keeps what it has, and the shape is marked old; 0: none"},
      {0, 1}, options.budget);
  if (options.budget > 0)
    options.clock = [] { return 1e-9 * static_cast<double>(loop::monotonic_ns()); };
  options.time_step = context.period;
  options.team = make_team(node);
  if (name == "corotational_dynamic") {
    return std::make_unique<elasticity::CorotationalDynamic>(body, options);
  }
  return std::make_unique<elasticity::CorotationalQuasistatic>(body, options);
}

Model make_mass_spring(const config::Node& node, const Context& context) {
  elasticity::MassSpringOptions options;
  options.iterations = node.integer({"iterations", "", "Newton corrections in a step, at most"},
                                    {1, 50}, options.iterations);
  options.tolerance = node.number(
      {"tolerance", "N", "largest force of a node out of balance at which a step ends early"},
      {1e-12, 1}, options.tolerance);
  options.cg_iterations =
      node.integer({"cg_iterations", "", "conjugate gradients in a correction, at most"},
                   {1, 10000}, options.cg_iterations);
  return std::make_unique<elasticity::MassSpringModel>(context.object->body, options);
}

Model make_shape_matching(const config::Node& node, const Context& context) {
  elasticity::ShapeMatchingOptions options;
  options.rings = node.integer({"rings", "", "of edges round each node that its region reaches"},
                               {1, 5}, options.rings);
  options.max_substeps =
      node.integer({"max_substeps", "", "that a step may be split into to be as stiff as E says"},
                   {1, 100}, options.max_substeps);
  return std::make_unique<elasticity::ShapeMatchingModel>(context.object->body, options);
}

}  // namespace

Model make_deformation_model(const config::Node& node, const Context& context) {
  const auto& plugins = plugins_of(context).deformation_models;
  const std::string name = node.choice({"component", "", "the mechanics"},
                                       plugin::with_plugins(plugin::kDeformationModels, plugins));
  if (const auto* entry = plugin::find_plugin(plugins, name))
    return make_plugin(*entry, node, context);
  try {
    if (name == "linear") return std::make_unique<elasticity::LinearModel>(context.object->body);
    if (name == "mass_spring") return make_mass_spring(node, context);
    if (name == "shape_matching") return make_shape_matching(node, context);
    return make_corotational(node, name, context);
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

}  // namespace palpate::registry
