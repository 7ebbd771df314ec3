#include <benchmark/benchmark.h>
#include <sched.h>

#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/element_set.hpp"
#include "core/factor/solve_panels.hpp"
#include "rt/loop/spin_team.hpp"
#include "tests/bench/core/elasticity/benchmarks.hpp"

namespace palpate::bench {
namespace {

/// The bar bent and rotated as after 50 ms of motion L.
Eigen::Matrix3Xd moved(const Scenario& scenario) {
  const auto model = make_model(scenario.body(), Mechanics::kDynamic, {});
  for (int k = 1; k <= 50; ++k) {
    scenario.apply(1e-3 * k, *model);
    model->step(1e-3);
    support::refactor(*model);
  }
  return model->positions();
}

/// Workers are scheduled like the calling thread.
std::unique_ptr<math::Team> team_of(int threads) {
  if (threads == 1) return std::make_unique<math::SoloTeam>();
  loop::SpinTeamOptions options;
  options.size = threads;
  sched_param own{};
  if (sched_getparam(0, &own) == 0) options.fifo_priority = own.sched_priority;
  return std::make_unique<loop::SpinTeam>(options);
}

/// One pass over all elements: energy and forces.
template <elasticity::Precision kPrecision>
void element_pass(benchmark::State& state, const BarMesh& mesh, int threads) {
  const auto team = team_of(threads);
  const Scenario scenario(mesh, Motion::kLarge);
  const mesh::ElementMesh& elements = scenario.body().mesh;
  const auto pass =
      elasticity::make_element_forces(elements, elasticity::ElementSet(scenario.body()).materials(),
                                      elasticity::mesh_numbering(elements), kPrecision, *team);
  elasticity::NodalField x = elasticity::NodalField::Zero(4, elements.node_count()), forces = x;
  x.topRows<3>() = moved(scenario);
  for (auto _ : state) {
    benchmark::DoNotOptimize(pass->add(x, 0, forces));
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * elements.element_count());
}

/// One solve with the loop's factor, the clamp held.
template <factor::PanelPrecision kPrecision>
void solve(benchmark::State& state, const BarMesh& mesh, int threads) {
  const auto team = team_of(threads);
  const Scenario scenario(mesh, Motion::kLarge);
  const elasticity::Body& body = scenario.body();
  const elasticity::ElementSet elements(body);
  const factor::BlockPattern pattern(body.mesh.elements, body.mesh.node_count(), {},
                                     elasticity::patches(body));
  const factor::Supernodes supernodes(pattern);
  factor::BlockMatrix matrix(pattern);
  Eigen::MatrixXd K;
  for (int e = 0; e < elements.element_count(); ++e) {
    elements.stiffness(e, body.mesh.nodes, elasticity::Tangent::kExact, 0, K);
    matrix.add(e, K);
  }
  factor::SupernodalFactor factor(supernodes);
  factor::SolvePanels panels(supernodes, kPrecision, *team);
  if (!factor.factorise(matrix) || !panels.assign(factor)) {
    state.SkipWithError("the stiffness is not positive definite");
    return;
  }
  const Eigen::VectorXf right = Eigen::VectorXf::Random(3 * pattern.size());
  Eigen::VectorXf b = right;
  for (auto _ : state) {
    b = right;
    panels.solve(b.data(), {true, true});
    benchmark::ClobberMemory();
  }
  state.counters["bytes"] = static_cast<double>(panels.bytes());
}

/// One run of the background thread's job, including sensitivities.
void refactorisation(benchmark::State& state, const BarMesh& mesh) {
  const Scenario scenario(mesh, Motion::kLarge);
  const auto model = make_model(scenario.body(), Mechanics::kDynamic, {});
  const Eigen::Matrix3Xd x = moved(scenario), v = Eigen::Matrix3Xd::Zero(3, x.cols());
  for (auto _ : state) {
    state.PauseTiming();
    model->restore(x, v);  // makes it request a new one
    elasticity::Refactorisation* job = model->wanted_refactorisation();
    state.ResumeTiming();
    if (job == nullptr) {
      state.SkipWithError("the model needs no refactorisation");
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
    for (const auto& [what, function] :
         {std::pair{std::string("element_pass/single"),
                    &element_pass<elasticity::Precision::kSingle>},
          {"element_pass/double", element_pass<elasticity::Precision::kDouble>},
          {"solve/single", solve<factor::PanelPrecision::kSingle>},
          {"solve/half", solve<factor::PanelPrecision::kHalf>}}) {
      for (int threads = 1; threads <= 4; ++threads) {
        const std::string name = what + size + "/team:" + std::to_string(threads);
        benchmark::RegisterBenchmark(name.c_str(), function, mesh, threads)
            ->Unit(benchmark::kMicrosecond)
            ->UseRealTime();
      }
    }
    benchmark::RegisterBenchmark(("refactorisation" + size).c_str(), refactorisation, mesh)
        ->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace palpate::bench
