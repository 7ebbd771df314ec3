// Scalar features of the shape, neither positions nor poses, controlled on the plant.

#include <cmath>
#include <functional>

#include "tests/integration/closed_loop/closed_loop.hpp"

namespace palpate {
namespace {

/// Tolerance of the plant, with a different mesh, for an unobserved shape; relative to the
/// commanded change.
constexpr double kBlind = 0.1;

/// Controls the feature by `change` from its hanging shape and returns the remaining error on the
/// plant, as a fraction of it; `truth` is the feature's value from the plant's positions.
double rest_on_the_plant(const std::string& configuration, std::vector<std::string> overrides,
                         double change, const std::function<double(ClosedLoop&)>& truth) {
  overrides.insert(overrides.end(), {"control.dead_band_mm=0.05", "control.dead_band_deg=0.05"});
  ClosedLoop loop("sim/scenes/bar_long_soft_control.yaml", configuration, {}, overrides);
  loop.run(0.1);
  loop.send_event("start");
  loop.run(1.0);
  const pipeline::Pipeline& pipeline = loop.daemon().pipeline();
  const double target = pipeline.feature_state().value[0] + change;
  EXPECT_GT(std::abs(truth(loop) - target), 0.8 * std::abs(change)) << "there is something to do";
  loop.send_target(pipeline.feature().kind(), Eigen::VectorXd::Constant(1, target));
  loop.run(6.0);
  EXPECT_TRUE(pipeline.is_running()) << pipeline.condition().reason;
  EXPECT_LT(std::abs(pipeline.feature_state().error[0]), 0.01 * std::abs(change));
  const double left = std::abs((truth(loop) - target) / change);
  std::printf("%s: %.2f %% of the way left\n", pipeline.feature().kind(), 100 * left);
  return left;
}

Eigen::Vector3d at(ClosedLoop& loop, int point) {
  return loop.simulation().plant().position_at(
      loop.daemon().pipeline().feature().rest_points()[point]);
}

TEST(ClosedLoop, BendsTheBarByAnAngle) {
  const auto truth = [](ClosedLoop& loop) {
    const Eigen::Vector3d a = at(loop, 1) - at(loop, 0);
    const Eigen::Vector3d b = at(loop, 3) - at(loop, 2);
    return std::atan2(b.z(), b.x()) - std::atan2(a.z(), a.x());  // about -y
  };
  EXPECT_LT(rest_on_the_plant("rt/config/examples/bar_long_soft_bend.yaml", {}, 0.25, truth),
            kBlind);
}

TEST(ClosedLoop, BringsTwoPointsNearerToEachOther) {
  const auto truth = [](ClosedLoop& loop) { return (at(loop, 1) - at(loop, 0)).norm(); };
  const std::string feature =
      "feature={component: distance, rest_points: [[0.05, 0.03, 0], [0.4, 0.03, 0.06]]}";
  EXPECT_LT(rest_on_the_plant("rt/config/examples/bar_long_soft.yaml", {feature}, -0.015, truth),
            kBlind);
}

}  // namespace
}  // namespace palpate
