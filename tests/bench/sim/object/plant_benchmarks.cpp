// What a step of 1 ms of the simulated object costs: the bar of the scenes, bent and held, by mesh
// and by what it is made of. "x_real_time" is simulated over real time on one core.
#include <benchmark/benchmark.h>

#include <cmath>

#include "sim/object/hyperelastic_plant.hpp"

namespace palpate::object {
namespace {

constexpr double kStep = 1e-3;

PlantOptions bar(int elements, int across) {
  PlantOptions options;
  options.elements = {elements, across, across};
  options.clamp = Box{{0, 0, 0}, {0, 0.06, 0.06}};
  options.gravity_O = {0, 0, -9.81};
  GraspOptions grasp;
  grasp.patch = {{0.45, 0, 0}, {0.5, 0.06, 0.06}};
  grasp.stiffness = 1e5;
  grasp.damping = 20;
  grasp.X_OG_rest.translation() = Eigen::Vector3d(0.47, 0.03, 0.03);
  options.grasps = {grasp};
  return options;
}

void report(benchmark::State& state, const HyperelasticPlant& plant, double substeps) {
  const auto steps = static_cast<double>(state.iterations());
  state.counters["nodes"] = static_cast<double>(plant.positions().cols());
  state.counters["substeps"] = substeps / steps;
  state.counters["x_real_time"] = benchmark::Counter(kStep * steps, benchmark::Counter::kIsRate);
}

/// Swings the hand up and down by 0.08 m and steps along.
void swing(benchmark::State& state, HyperelasticPlant& plant, const math::Pose& X_start) {
  double t = 0, substeps = 0;
  math::Pose X = X_start;
  for (auto _ : state) {
    t += kStep;
    const double rate = 3.14159;
    X.translation().z() = X_start.translation().z() + 0.04 * (std::cos(rate * t) - 1);
    const math::Twist V{{0, 0, -0.04 * rate * std::sin(rate * t)}, Eigen::Vector3d::Zero()};
    plant.step(kStep, X, V);
    substeps += plant.substeps();
  }
  report(state, plant, substeps);
}

void plant_step_mesh(benchmark::State& state) {
  const PlantOptions options =
      bar(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  HyperelasticPlant plant(options);
  swing(state, plant, options.grasps[0].X_OG_rest);
}
BENCHMARK(plant_step_mesh)
    ->ArgNames({"along", "across"})
    ->Args({14, 1})
    ->Args({20, 1})
    ->Args({30, 1})
    ->Args({20, 2})
    ->Args({40, 2})
    ->Unit(benchmark::kMicrosecond);

template <class Change>
void plant_step_with(benchmark::State& state, const Change& change) {
  PlantOptions options = bar(20, 1);
  change(options);
  HyperelasticPlant plant(options);
  swing(state, plant, options.grasps[0].X_OG_rest);
}
BENCHMARK_CAPTURE(plant_step_with, grip, [](PlantOptions& o) {
  o.grasps[0].grip = 5;
})->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plant_step_with, kelvin_voigt, [](PlantOptions& o) {
  o.viscosity = 1;
})->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plant_step_with, maxwell, [](PlantOptions& o) {
  o.maxwell = {{0.3, 0.5}};
})->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plant_step_with, yield, [](PlantOptions& o) {
  o.yield = Yield{500, 1e3};
})->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plant_step_with, regions, [](PlantOptions& o) {
  o.regions = {{{{0, 0, 0}, {0.25, 1, 1}}, 60e3}};
})->Unit(benchmark::kMicrosecond);
/// Five fingertips pressed by 2 mm into the bar from below, near the hand, which stands still.
void plant_step_five_fingertips(benchmark::State& state) {
  PlantOptions options = bar(20, 1);
  options.fingertips.resize(5);
  HyperelasticPlant plant(options);
  plant.settle(20, 1e-4);
  for (int i = 0; i < plant.fingertip_count(); ++i) {
    const Eigen::Vector3d below = plant.position_at({0.36 + 0.018 * i, 0.03, 0});
    plant.move_fingertip(i, below - Eigen::Vector3d(0, 0, 0.006), {});
  }
  double substeps = 0;
  for (auto _ : state) {
    plant.step(kStep);
    substeps += plant.substeps();
  }
  report(state, plant, substeps);
}
BENCHMARK(plant_step_five_fingertips)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace palpate::object

BENCHMARK_MAIN();
