// The pose-and-wrench filter compared with pose-driven estimation, in the simulator, whose plant is
// unknown to both.
#include "tests/integration/closed_loop/closed_loop.hpp"

namespace palpate {
namespace {

constexpr const char* kScene = "sim/scenes/bar_long_soft_six_poses.yaml";
constexpr const char* kPokeScene = "sim/scenes/bar_long_soft_poke.yaml";
constexpr const char* kFilterConfiguration = "rt/config/examples/bar_long_soft.yaml";
constexpr const char* kFilter = "estimation.component=pose_wrench_filter";
const double kTrueLogYoung = std::log(30e3);

struct Result {
  double mean = 0;  // m, shape error over all nodes and samples
  double largest = 0;
  estimation::Estimate estimate;
};

Result estimate_over_two_poses(std::vector<std::string> overrides) {
  ClosedLoop loop(kScene, kFilterConfiguration,
                  {"sensors.force_torque.bias=[0.0333, 0.0167, -0.0333, 0, 0, 0]"},
                  std::move(overrides));
  loop.run(0.1);
  loop.send_event("start");
  loop.run(2.0);
  Result result;
  constexpr int kLooks = 40;
  for (int i = 0; i < kLooks; ++i) {
    loop.run(0.25);
    const Eigen::VectorXd error = loop.shape_error();
    result.mean += error.mean() / kLooks;
    result.largest = std::max(result.largest, error.maxCoeff());
  }
  result.estimate = loop.daemon().pipeline().estimate();
  EXPECT_EQ(loop.daemon().pipeline().condition().state, pipeline::LifeCycle::kActive)
      << loop.daemon().pipeline().condition().reason;
  return result;
}

TEST(Filter, FindsTheStiffnessThatIsConfiguredWrongly) {
  double means = 0;
  for (const char* wrong_stiffness :
       {"object.material.young_modulus=21e3", "object.material.young_modulus=39e3"}) {
    const Result alone = estimate_over_two_poses({wrong_stiffness});
    const Result filter = estimate_over_two_poses({wrong_stiffness, kFilter});
    const double log_young = filter.estimate.log_young_modulus;
    std::printf(
        "%s: pose alone %.2f / %.2f mm, filter %.2f / %.2f mm, E %.1f kPa, deviation %.0f %%\n",
        wrong_stiffness, 1e3 * alone.mean, 1e3 * alone.largest, 1e3 * filter.mean,
        1e3 * filter.largest, 1e-3 * std::exp(log_young),
        100 * filter.estimate.log_young_modulus_deviation);
    EXPECT_NEAR(log_young, kTrueLogYoung, 0.15);
    EXPECT_LT(filter.largest, alone.largest);
    means += filter.mean - alone.mean;
    EXPECT_FALSE(filter.estimate.unknown_contact.found);
  }
  EXPECT_LT(means, 0) << "the one taken with the other";
}

TEST(Filter, FeelsAPushThatNothingMeasures) {
  constexpr double kPushed = 5, kReleased = 8;  // s, of the scene's first poke
  const Eigen::Vector3d rest_point(0.25, 0.03, 0.06);
  ClosedLoop loop(kPokeScene, kFilterConfiguration, {}, {kFilter});
  loop.run(0.1);
  loop.send_event("start");
  double time = 0.1, found_at = -1, lost_at = -1;
  // Of its last second: detections during the rise do not count.
  constexpr double kFrom = kReleased - 1.1, kTo = kReleased - 0.1;
  double distance = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  int looks = 0;
  loop.run(9.8, [&] {
    time += 1e-3;
    const estimation::UnknownContact& contact = loop.daemon().pipeline().estimate().unknown_contact;
    if (contact.found) {
      if (found_at < 0) found_at = time;
      if (time > kFrom && time < kTo) {
        ++looks;
        force += contact.force_O;
        distance += (contact.location_O - loop.simulation().plant().position_at(rest_point)).norm();
      }
    } else if (found_at > 0 && lost_at < 0) {
      lost_at = time;
    }
  });
  force /= looks;
  distance /= looks;
  std::printf("found after %.0f ms, gone after %.0f ms; %.1f mm off, force %.2f %.2f %.2f N\n",
              1e3 * (found_at - kPushed), 1e3 * (lost_at - kReleased), 1e3 * distance, force.x(),
              force.y(), force.z());
  ASSERT_GT(found_at, kPushed) << "no false alarm, but found";
  EXPECT_LT(found_at, kPushed + 0.3);
  EXPECT_GT(lost_at, kReleased);
  EXPECT_LT(distance, 0.04);
  EXPECT_LT((force - Eigen::Vector3d(0, 0, -0.5)).norm(), 0.1) << "of 0.5 N";
}

/// Object of the examples, with a different stiffness in the daemon's configuration.
class NoPush : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(NoPush, IsFoundWhereTheHandMovesAndRests) {
  const auto [object, young] = GetParam();
  const std::string name = object;
  ClosedLoop loop("sim/scenes/" + name + "_six_poses.yaml", "rt/config/examples/" + name + ".yaml",
                  {"sensors.force_torque.bias=[0.0333, 0.0167, -0.0333, 0, 0, 0]"},
                  {kFilter, "object.material.young_modulus=" + std::string(young)});
  loop.run(0.1);
  loop.send_event("start");
  double time = 0.1, largest = 0;
  loop.run(25.9, [&] {
    time += 1e-3;
    const estimation::UnknownContact& contact = loop.daemon().pipeline().estimate().unknown_contact;
    ASSERT_FALSE(contact.found) << "at " << time << " s: " << contact.force_O.transpose()
                                << " N at " << contact.location_O.transpose() << " m";
    if (std::lround(1e3 * time) % 50 == 0)
      largest = std::max(largest, loop.shape_error().maxCoeff());
  });
  std::printf("%s, %s Pa: largest error of the shape %.2f mm\n", object, young, 1e3 * largest);
  EXPECT_LT(largest, 8e-3);
}

INSTANTIATE_TEST_SUITE_P(Filter, NoPush,
                         ::testing::Values(std::pair("bar_long_soft", "39e3"),
                                           std::pair("bar_long_hard", "42e3"),
                                           std::pair("block_hard", "78e3")));

}  // namespace
}  // namespace palpate
