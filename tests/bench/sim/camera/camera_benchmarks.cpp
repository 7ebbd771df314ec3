// Frame rate of the depth camera at 640 x 480: a bar with the given number of triangles, an arm and
// a hand of thirty primitive shapes in front of it.

#include <benchmark/benchmark.h>

#include <cmath>

#include "sim/camera/shape_camera.hpp"

namespace palpate::camera {
namespace {

constexpr int kMostPoints = 256;

/// A bar whose sides are a grid of `n` by 8 cells of two triangles.
draw::TriangleMesh bar(int n) {
  constexpr int kAround = 8;
  Eigen::Matrix2Xd profile(2, n + 1);
  for (int i = 0; i <= n; ++i) profile.col(i) << 0.04, 0.5 * i / n - 0.25;
  return draw::make_revolution(profile, kAround);
}

std::vector<Body> bodies(int triangles) {
  const auto shared = [](draw::TriangleMesh mesh) {
    return std::make_shared<const draw::TriangleMesh>(std::move(mesh));
  };
  const draw::Colour amber{0.95F, 0.72F, 0.30F, 1}, grey{0.60F, 0.62F, 0.65F, 1};
  std::vector<Body> all{{shared(bar(triangles / 16)), math::Pose::Identity(), amber, true}};
  const auto link = shared(draw::make_cylinder(0.02, 0.12));
  for (int i = 0; i < 30; ++i) {
    const double angle = 0.2 * i;
    all.push_back({link,
                   math::make_pose(math::exp_rotation({angle, 0.3 * angle, 0}),
                                   {0.1 * std::cos(angle), -0.1, 0.2 + 0.02 * i}),
                   grey, false});
  }
  return all;
}

math::Pose camera_pose() { return draw::look_at({0.2, -0.8, 0.2}, {0, 0, 0}, {0, 0, 1}); }

void report_rate(benchmark::State& state) {
  state.counters["frames"] = benchmark::Counter(state.iterations(), benchmark::Counter::kIsRate);
}

void depth_and_colour(benchmark::State& state) {
  DepthCamera camera;
  const std::vector<Body> all = bodies(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(camera.take(camera_pose(), all).depth.metres[0]);
  report_rate(state);
}

void noise(benchmark::State& state) {
  DepthCamera camera;
  const DepthNoise errors(DepthNoiseOptions(), camera.intrinsics());
  const DepthFrame frame = camera.take(camera_pose(), bodies(1000));
  std::uint64_t seed = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(errors.apply(frame.depth, math::Random(++seed)).metres[0]);
  report_rate(state);
}

void shape_observation(benchmark::State& state) {
  ShapeCameraOptions options;
  options.X_WC = camera_pose();
  options.filter.lower.setConstant(-0.4);
  options.filter.upper.setConstant(0.4);
  options.filter.colour = {0.95F, 0.72F, 0.30F, 1};
  ShapeCamera camera(options);
  const std::vector<Body> all = bodies(static_cast<int>(state.range(0)));
  std::uint64_t seed = 0;
  Eigen::Index points = 0;
  for (auto _ : state) points = camera.look(all, math::Random(++seed), kMostPoints).points_W.cols();
  if (points == 0) state.SkipWithError("ERROR OCCURRED: the camera sees nothing");
  report_rate(state);
  state.counters["points"] = static_cast<double>(points);
}

BENCHMARK(depth_and_colour)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);
BENCHMARK(noise)->Unit(benchmark::kMillisecond);
BENCHMARK(shape_observation)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace palpate::camera

BENCHMARK_MAIN();
