#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/thesis2018.hpp"
#include "rt/component/registry.hpp"

namespace palpate::component {

std::unique_ptr<elasticity::DeformationModel> make_deformation_model(const config::Node& node,
                                                                     const Context& context) {
  const std::string name =
      node.choice("component", {"corotational_quasistatic", "corotational_dynamic"});
  const std::string integrator =
      node.choice("integrator", {"backward_euler", "thesis2018"}, "backward_euler");
  const elasticity::Body& body = context.object->body;
  try {
    if (integrator == "thesis2018") {
      if (name != "corotational_dynamic") {
        node.fail("integrator", "thesis2018 needs component corotational_dynamic");
      }
      return std::make_unique<elasticity::Thesis2018>(body);
    }
    elasticity::SolverOptions options;
    options.iterations = node.integer("iterations", {1, 50}, options.iterations);
    options.tolerance = node.number("tolerance", {1e-12, 1}, options.tolerance);
    options.time_step = context.period;
    if (name == "corotational_dynamic") {
      return std::make_unique<elasticity::CorotationalDynamic>(body, options);
    }
    return std::make_unique<elasticity::CorotationalQuasistatic>(body, options);
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

}  // namespace palpate::component
