#include "tools/lab/baselines/components.hpp"
#include "tools/lab/baselines/deformation/as_rigid_as_possible.hpp"

namespace palpate::baselines {

void add_deformation_models(plugin::PluginRegistrar& registrar) {
  using Options = AsRigidAsPossibleOptions;
  registrar.deformation_models.add(
      "as_rigid_as_possible",
      config::OptionTable<Options>()
          .integer("iterations", "pairs of a local and a global step, at most", {1, 100},
                   &Options::iterations)
          .number("accuracy", "m", "a step ends where an iteration moves no node further",
                  {0, 1e-3}, &Options::accuracy),
      [](const Options& options, const plugin::PluginCell& cell) {
        return std::unique_ptr<elasticity::DeformationModel>(
            std::make_unique<AsRigidAsPossible>(*cell.body, options));
      });
}

}  // namespace palpate::baselines
