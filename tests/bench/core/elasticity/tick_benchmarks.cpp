#include "tests/bench/core/elasticity/benchmarks.hpp"

#include <benchmark/benchmark.h>

#include "tests/bench/core/elasticity/baseline_model.hpp"
#include "tests/bench/core/elasticity/refactor_service.hpp"

namespace palpate::bench {
namespace {

constexpr double kDt = 1e-3;  // s

std::string name_of(const char* what, const BarMesh& mesh, Mechanics mechanics) {
  return std::string(what) + "/" +
         (mesh.order == mesh::ElementOrder::kLinear ? "linear" : "quadratic") + "/" +
         std::to_string(mesh.node_count()) +
         (mechanics == Mechanics::kDynamic ? "/dynamic" : "/quasistatic");
}

/// Steps in motion L; only the step itself and the hand-over of factors are timed.
void tick(benchmark::State& state, const BarMesh& mesh, Mechanics mechanics, int iterations) {
  const Scenario scenario(mesh, Motion::kLarge);
  elasticity::SolverOptions solver;
  solver.iterations = iterations;
  const auto model = make_model(scenario.body(), mechanics, solver);
  RefactorService service({RefactorPolicy::kDelayed, 20});
  long step = 0;
  double taken = 0;
  for (auto _ : state) {
    ++step;
    scenario.apply(kDt * static_cast<double>(step), *model);
    const double begin = wall_time();
    service.collect(*model, step);
    const elasticity::StepReport report = model->step(kDt);
    service.request(*model, step);
    state.SetIterationTime(wall_time() - begin);
    service.run_here();
    taken += report.iterations;
  }
  state.counters["iterations"] = taken / static_cast<double>(step);
  state.counters["factors"] = static_cast<double>(service.count());
}

/// The same steps by a baseline, which follows its own trajectory.
void baseline_tick(benchmark::State& state, const BarMesh& mesh, BaselineModel::Solver solver) {
  const Scenario scenario(mesh, Motion::kLarge);
  const auto loads = make_model(scenario.body(), Mechanics::kDynamic, {});
  BaselineModel model(scenario.body(), solver, true);
  long step = 0;
  double taken = 0;
  for (auto _ : state) {
    const double t = kDt * static_cast<double>(++step);
    scenario.apply(t, *loads);
    const math::Pose clamp = scenario.clamp_pose(t);
    const double begin = wall_time();
    const bool good = model.step(kDt, clamp, loads->loads());
    state.SetIterationTime(wall_time() - begin);
    taken += model.iterations();
    if (!good) state.SkipWithError("the tangent is not positive definite");
  }
  state.counters["iterations"] = taken / static_cast<double>(step);
}

}  // namespace

void register_ticks(const std::vector<BarMesh>& meshes) {
  for (const BarMesh& mesh : meshes) {
    for (const auto mechanics : {Mechanics::kDynamic, Mechanics::kQuasistatic}) {
      for (const int iterations : {1, 2, 3}) {
        const std::string name =
            name_of("tick", mesh, mechanics) + "/iterations:" + std::to_string(iterations);
        benchmark::RegisterBenchmark(name.c_str(), tick, mesh, mechanics, iterations)
            ->UseManualTime()
            ->Unit(benchmark::kMicrosecond);
      }
    }
    for (const auto& [what, solver] :
         {std::pair{"full_cholmod", BaselineModel::Solver::kCholmod},
          std::pair{"jacobi_pcg", BaselineModel::Solver::kJacobiPcg}}) {
      benchmark::RegisterBenchmark(name_of(what, mesh, Mechanics::kDynamic).c_str(), baseline_tick,
                                   mesh, solver)
          ->UseManualTime()
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

}  // namespace palpate::bench
