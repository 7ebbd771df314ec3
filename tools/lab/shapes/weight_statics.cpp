#include "tools/lab/shapes/weight_statics.hpp"

#include <stdexcept>

#include "core/solid/solid_solver.hpp"
#include "tools/lab/cases/case_run.hpp"

namespace palpate::shapes {
namespace {

Eigen::Matrix3Xd rest_of_solid(const elasticity::Body& body, double mooney) {
  if (!body.element_materials.empty())
    throw std::invalid_argument("the hyperelastic model has one material, the body several");
  const elasticity::Material& material = body.material;
  const solid::SolidBody solid(body.mesh, body.fixed_nodes);
  solid::SolidSolver solver(solid);
  const Eigen::Matrix3Xd weight =
      material.density * body.gravity_O * solid.nodal_volume().transpose();
  Eigen::Matrix3Xd x = body.mesh.nodes;
  const solid::SolidMaterial constants =
      solid::make_solid_material(material.young_modulus, material.poisson_ratio, mooney);
  if (!solver.solve(constants.coefficients, weight, x))
    throw std::runtime_error("no hyperelastic equilibrium under the weight was found");
  return x;
}

}  // namespace

const char* name_of(Law law) {
  return law == Law::kCorotational ? "co-rotational" : "hyperelastic";
}

Eigen::Matrix3Xd rest_under_weight(const cases::CaseProblem& problem, Law law, double mooney) {
  if (law == Law::kHyperelastic) return rest_of_solid(problem.body, mooney);
  elasticity::StaticSolution solution = cases::solve(problem);
  if (!solution.converged)
    throw std::runtime_error("no co-rotational equilibrium under the weight was found");
  return std::move(solution.positions);
}

double incremental_deviation(const cases::CaseProblem& problem, const Eigen::Matrix3Xd& positions) {
  constexpr int kTicks = 500;
  const cases::IncrementalRun run = cases::run_incremental(problem, positions, kTicks);
  if (!run.converged) throw std::runtime_error("the incremental model did not come to rest");
  return run.deviation;
}

}  // namespace palpate::shapes
