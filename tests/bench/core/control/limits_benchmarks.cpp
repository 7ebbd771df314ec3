// Cost of limits per cycle of the controller: the search for the worst elements, and the whole law
// with one grasp, by the number of nodes of a quadratic mesh.

#include <benchmark/benchmark.h>

#include "core/control/jacobian_providers.hpp"
#include "core/control/quadratic_program.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/shape/point_features.hpp"

namespace palpate::bench {
namespace {

elasticity::Body bar(int cells) {
  elasticity::Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box({0.5, 0.06, 0.06}, {cells, 1, 1}),
                                      mesh::ElementOrder::kQuadratic);
  elasticity::GraspRegion grasp;
  for (int i = 0; i < body.mesh.node_count(); ++i) {
    if (body.mesh.nodes(0, i) < 1e-9) body.fixed_nodes.push_back(i);
    if (body.mesh.nodes(0, i) > 0.5 - 1e-9) grasp.nodes.push_back(i);
  }
  grasp.X_OG_rest.translation() << 0.5, 0.03, 0.03;
  body.grasps.push_back(grasp);
  return body;
}

void count_nodes(benchmark::State& state, const elasticity::Body& body) {
  state.counters["nodes"] = body.mesh.node_count();
  state.counters["elements"] = body.mesh.element_count();
}

void worst_elements(benchmark::State& state, elasticity::Strain strain) {
  const elasticity::Body body = bar(static_cast<int>(state.range(0)));
  elasticity::WorstElements worst(body, strain);
  std::srand(1);
  const Eigen::Matrix3Xd some = Eigen::Matrix3Xd::Random(3, body.mesh.node_count());
  double phase = 0;
  Eigen::Matrix3Xd x;
  for (auto _ : state) {
    state.PauseTiming();
    x = body.mesh.nodes + 5e-4 * std::sin(phase += 0.01) * some;
    state.ResumeTiming();
    benchmark::DoNotOptimize(worst.look(x));
  }
  count_nodes(state, body);
}

/// A tick of the law; bit 0: with limits of stress and stretch, bit 1: with all others.
void law(benchmark::State& state) {
  const elasticity::Body body = bar(static_cast<int>(state.range(0)));
  elasticity::CorotationalQuasistatic model(body);
  model.prepare();
  math::Pose X = body.grasps[0].X_OG_rest;
  X.translation().z() += 0.03;
  model.hold(0, X);
  for (int i = 0; i < 20; ++i) {
    if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
      job->run();
      model.install(*job);
    }
    model.step(1e-3);
  }
  shape::PointFeature feature(body.mesh,
                              shape::PointFeature::Options{{Eigen::Vector3d(0.25, 0.03, 0.06)}});
  control::TwistLawOptions options;
  options.dead_band = {1e-4, 1e-3, 1.2};
  control::QuadraticProgramLaw::Limited limited;
  limited.body = &body;
  if (state.range(1) & 1) {
    limited.limits.stress = 500;
    limited.limits.stretch = 1.01;
  }
  if (state.range(1) & 2) {
    limited.limits.force = 1;
    limited.limits.slip.pinch = 1;
    control::LimitedObstacle ball;
    ball.body.shape = collision::Sphere{0.04};
    ball.body.X_OB.translation() << 0.2, 0.03, 0.14;
    limited.limits.obstacles.assign(4, ball);
  }
  control::QuadraticProgramLaw law(options, limited);
  law.configure_for(feature);
  control::FemJacobian provider{control::FemJacobian::Options{}};
  Eigen::VectorXd value = Eigen::VectorXd::Zero(3), error = value;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, 6);
  control::LawOutput output;
  output.unreachable.setZero(3);
  feature.evaluate(model.positions(), value);
  const Eigen::VectorXd target = value + Eigen::Vector3d(0, 0, 0.03);
  feature.error(value, target, error);
  provider.update(feature, model, X, J);
  control::LawInputs inputs;
  inputs.value = &value;
  inputs.target = &target;
  inputs.error = &error;
  inputs.jacobian = &J;
  inputs.model = &model;
  inputs.X_OG[0] = X;
  inputs.reaction[0] = model.reaction(0);
  for (auto _ : state) {
    law.compute(inputs, output);
    benchmark::DoNotOptimize(output);
  }
  count_nodes(state, body);
}

BENCHMARK_CAPTURE(worst_elements, stress, elasticity::Strain::kStress)->Arg(10)->Arg(30);
BENCHMARK_CAPTURE(worst_elements, stretch, elasticity::Strain::kStretch)->Arg(10)->Arg(30);
BENCHMARK(law)->ArgsProduct({{10, 30}, {0, 1, 2, 3}})->ArgNames({"cells", "limits"});

}  // namespace
}  // namespace palpate::bench

BENCHMARK_MAIN();
