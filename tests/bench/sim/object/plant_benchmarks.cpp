// Cost of a step of 1 ms of the simulated object: the bar of the scenes, bent and held, by mesh and
// by material. "x_real_time" is simulated over real time on one core.
//
// plant_mesh also reports the error of a mesh relative to 60 x 4 x 4, in percent: largest
// difference of the shape relative to the largest displacement, of force and torque of the hand
// relative to theirs; the worst of two poses, lowered by 80 mm and twisted by 46 degrees while
// moved sideways. Minimum times on a busy machine: --benchmark_filter=plant_mesh | grep _min (runs
// for some minutes).
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "sim/object/hyperelastic_plant.hpp"

namespace palpate::object {
namespace {

constexpr double kStep = 1e-3;

using Mesh = std::array<int, 3>;  // elements along, across and up

PlantOptions bar(const Mesh& mesh) {
  PlantOptions options;
  options.elements = mesh;
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

/// Equilibrium of the bar at one pose of the hand.
struct Bent {
  Eigen::Matrix3Xd moved;  // m, of points along it
  math::Wrench hand;
};

Bent bend(const Mesh& mesh, bool twisted) {
  constexpr int kSteps = 200;
  const PlantOptions options = bar(mesh);
  math::Pose X = options.grasps[0].X_OG_rest;
  math::Twist V{{0, 0, -0.4}, Eigen::Vector3d::Zero()};
  if (twisted) V = {{-0.1, 0.2, 0}, {4, 0, 0}};
  HyperelasticPlant plant(options);
  for (int i = 0; i < kSteps; ++i) {
    X.translation() += kStep * V.linear;
    X.linear() = Eigen::AngleAxisd(kStep * V.angular.x(), Eigen::Vector3d::UnitX()) * X.linear();
    plant.step(kStep, X, V);
  }
  plant.settle(20, 1e-4);
  Bent bent;
  bent.moved.resize(3, 30);
  for (int i = 0; i < bent.moved.cols(); ++i) {
    const Eigen::Vector3d p(0.025 + 0.05 * (i / 3), 0.03, 0.03 * (i % 3));
    bent.moved.col(i) = plant.position_at(p) - p;
  }
  bent.hand = plant.hand_wrench();
  return bent;
}

/// Percent; shape, force, torque.
using Errors = std::array<double, 3>;

Errors errors_of(const Mesh& mesh) {
  constexpr Mesh kFine{60, 4, 4};
  static const std::array<Bent, 2> fine{bend(kFine, false), bend(kFine, true)};
  Errors errors{};
  for (const bool twisted : {false, true}) {
    const Bent bent = bend(mesh, twisted);
    const Bent& best = fine[twisted ? 1 : 0];
    const auto keep_worst = [](double& worst, double difference, double size) {
      worst = std::max(worst, 100 * difference / size);
    };
    keep_worst(errors[0], (bent.moved - best.moved).colwise().norm().maxCoeff(),
               best.moved.colwise().norm().maxCoeff());
    keep_worst(errors[1], (bent.hand.force - best.hand.force).norm(), best.hand.force.norm());
    keep_worst(errors[2], (bent.hand.torque - best.hand.torque).norm(), best.hand.torque.norm());
  }
  return errors;
}

void run_mesh(benchmark::State& state, const Mesh& mesh) {
  const PlantOptions options = bar(mesh);
  HyperelasticPlant plant(options);
  swing(state, plant, options.grasps[0].X_OG_rest);
}

Mesh mesh_of(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
          static_cast<int>(state.range(2))};
}

void plant_step(benchmark::State& state) { run_mesh(state, mesh_of(state)); }
BENCHMARK(plant_step)->Args({20, 1, 1})->Args({20, 2, 2})->Unit(benchmark::kMicrosecond);

void plant_mesh(benchmark::State& state) {
  static std::map<Mesh, Errors> known;  // of repetitions
  const Mesh mesh = mesh_of(state);
  if (known.count(mesh) == 0) known[mesh] = errors_of(mesh);
  run_mesh(state, mesh);
  state.counters["shape_%"] = known[mesh][0];
  state.counters["force_%"] = known[mesh][1];
  state.counters["torque_%"] = known[mesh][2];
}
BENCHMARK(plant_mesh)
    ->ArgNames({"along", "across", "up"})
    ->Args({10, 1, 1})
    ->Args({14, 1, 1})
    ->Args({20, 1, 1})
    ->Args({30, 1, 1})
    ->Args({20, 1, 2})
    ->Args({20, 2, 1})
    ->Args({30, 1, 2})
    ->Args({10, 2, 2})
    ->Args({20, 2, 2})
    ->Args({30, 2, 2})
    ->Args({20, 3, 3})
    ->Repetitions(5)
    ->ComputeStatistics("min",
                        [](const std::vector<double>& all) {
                          return *std::min_element(all.begin(), all.end());
                        })
    ->ReportAggregatesOnly()
    ->Unit(benchmark::kMicrosecond);

template <class Change>
void plant_step_with(benchmark::State& state, const Change& change) {
  PlantOptions options = bar({20, 1, 1});
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
  PlantOptions options = bar({20, 1, 1});
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
