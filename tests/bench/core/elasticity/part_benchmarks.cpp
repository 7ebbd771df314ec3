#include <benchmark/benchmark.h>

#include "core/elasticity/block_ldl.hpp"
#include "core/elasticity/element_set.hpp"
#include "tests/bench/core/elasticity/benchmarks.hpp"

namespace palpate::bench {
namespace {

/// The bar bent and turned as 50 ms of motion L leave it.
Eigen::Matrix3Xd moved(const Scenario& scenario) {
  const auto model = make_model(scenario.body(), Mechanics::kDynamic, {});
  for (int k = 1; k <= 50; ++k) {
    scenario.apply(1e-3 * k, *model);
    model->step(1e-3);
    refactor_now(*model);
  }
  return model->positions();
}

/// One pass over all elements: energy and forces.
void element_pass(benchmark::State& state, const BarMesh& mesh) {
  const Scenario scenario(mesh, Motion::kLarge);
  const elasticity::ElementSet elements(scenario.body().mesh, scenario.body().material);
  auto memory = elements.make_state();
  const Eigen::Matrix3Xd x = moved(scenario);
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, x.cols());
  for (auto _ : state) {
    benchmark::DoNotOptimize(elements.add_forces(x, 0, memory, forces));
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * elements.element_count());
}

/// One solve with the loop's factor.
void solve(benchmark::State& state, const BarMesh& mesh) {
  const Scenario scenario(mesh, Motion::kLarge);
  const elasticity::Body& body = scenario.body();
  const elasticity::ElementSet elements(body.mesh, body.material);
  const elasticity::BlockPattern pattern(body.mesh.elements, body.mesh.node_count(),
                                         body.grasps[0].nodes);
  elasticity::BlockMatrix matrix(pattern);
  matrix.set_zero();
  Eigen::MatrixXd K;
  for (int e = 0; e < elements.element_count(); ++e) {
    elements.stiffness(e, body.mesh.nodes, elasticity::Tangent::kExact, 0, K);
    matrix.add(e, K);
  }
  elasticity::BlockLdl ldl(pattern);
  if (!ldl.factorise(matrix, std::vector<char>(pattern.size(), 0), 0)) {
    state.SkipWithError("the stiffness is not positive definite");
  }
  const Eigen::Matrix4Xd right = Eigen::Matrix4Xd::Random(4, pattern.size());
  Eigen::Matrix4Xd b = right;
  for (auto _ : state) {
    b = right;
    ldl.solve(b);
    benchmark::ClobberMemory();
  }
  state.counters["blocks"] = static_cast<double>(ldl.block_count());
}

/// One run of the job that the background thread has, sensitivities included.
void refactorisation(benchmark::State& state, const BarMesh& mesh) {
  const Scenario scenario(mesh, Motion::kLarge);
  const auto model = make_model(scenario.body(), Mechanics::kDynamic, {});
  const Eigen::Matrix3Xd x = moved(scenario), v = Eigen::Matrix3Xd::Zero(3, x.cols());
  for (auto _ : state) {
    state.PauseTiming();
    model->restore(x, v);  // makes it want a new one
    elasticity::Refactorisation* job = model->wanted_refactorisation();
    state.ResumeTiming();
    if (job == nullptr) {
      state.SkipWithError("the model wants no refactorisation");
      break;
    }
    job->run();
    state.PauseTiming();
    model->install(*job);
    state.ResumeTiming();
  }
}

}  // namespace

void register_parts(const std::vector<BarMesh>& meshes) {
  for (const BarMesh& mesh : meshes) {
    const std::string size =
        (mesh.order == mesh::ElementOrder::kLinear ? "/linear/" : "/quadratic/") +
        std::to_string(mesh.node_count());
    for (const auto& [what, function] : {std::pair{"element_pass", element_pass},
                                         {"solve", solve},
                                         {"refactorisation", refactorisation}}) {
      benchmark::RegisterBenchmark((what + size).c_str(), function, mesh)
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

}  // namespace palpate::bench
