#include "tools/lab/scores/belief_score.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/tools/lab/scores/synthetic_run.hpp"

namespace palpate::scores {
namespace {

Eigen::Vector3d still(const Eigen::Vector3d& p, double) { return p; }

/// One node of four is off by 8 mm, the others by 2 mm; all report `deviation`.
log::RunLog run_with(float deviation) {
  log::RunLog run = synthetic_run(
      still,
      [](const Eigen::Vector3d& p, double) -> Eigen::Vector3d {
        return p + Eigen::Vector3d(p.x() > 0.35 ? 8e-3 : 2e-3, 0, 0);
      },
      1);
  for (shape_t& shape : run.shapes) {
    shape.deviation.assign(static_cast<std::size_t>(shape.node_count), deviation);
    shape.deviation_count = shape.node_count;
  }
  return run;
}

estimate_t estimate_at(double time, double log_young, double deviation) {
  estimate_t estimate = {};
  estimate.utime = static_cast<std::int64_t>(time * 1e6);
  estimate.log_young_modulus = log_young;
  estimate.log_young_modulus_deviation = deviation;
  estimate.unknown_contact_deviation = -1;
  return estimate;
}

TEST(BeliefScore, CountsTheNodesWithinTheirIntervals) {
  EXPECT_EQ(score_belief(run_with(0.5e-3F)).covered, 0.0);
  EXPECT_EQ(score_belief(run_with(1e-3F)).covered, 0.75);
  EXPECT_EQ(score_belief(run_with(4e-3F)).covered, 1.0);
  EXPECT_NEAR(score_belief(run_with(4e-3F)).deviation, 4e-3, 1e-8);
  EXPECT_FALSE(score_belief(run_with(-1)).covered) << "not observable is no interval";
}

TEST(BeliefScore, FollowsTheModulusTenTimesASecond) {
  log::RunLog run = run_with(1e-3F);
  for (int i = 0; i < 900; ++i)
    run.estimates.push_back(estimate_at(0.01 + 1e-3 * i, std::log(30e3), i < 500 ? -1 : 0.1));
  const BeliefScore score = score_belief(run);
  ASSERT_EQ(score.modulus.size(), 9u);
  EXPECT_NEAR(score.modulus.back().young_modulus, 30e3, 1e-6);
  EXPECT_EQ(score.modulus.front().log_deviation, -1);
  const auto json = to_json(score);
  EXPECT_NEAR(json["young_modulus_kpa"].get<double>(), 30, 1e-9);
  EXPECT_TRUE(json["first_unknown_contact_s"].is_null());
}

TEST(BeliefScore, ReportsTheModulusAfterThreeSecondsOfMotion) {
  log::RunLog run = run_with(1e-3F);
  double x = 0;
  for (int i = 0; i < 100; ++i) {  // moves in every other second
    const double time = 0.001 + 0.1 * i;
    if (i / 10 % 2 == 1) x += 1e-3;
    run.estimates.push_back(estimate_at(time, std::log(1e3 * (1 + i)), 0.1));
    run.estimates.back().grasp_count = 1;
    run.estimates.back().grasp_position[0][0] = x;
  }
  // It has moved from 1 to 2, from 3 to 4 and from 5 to 6 s.
  EXPECT_NEAR(to_json(score_belief(run))["young_modulus_in_3s_of_motion_kpa"].get<double>(), 60,
              1.01);
  run.estimates.resize(50);
  EXPECT_FALSE(to_json(score_belief(run)).contains("young_modulus_in_3s_of_motion_kpa"));
}

TEST(BeliefScore, WithoutAnEstimatedModulusThereIsNone) {
  log::RunLog run = run_with(1e-3F);
  for (int i = 0; i < 900; ++i) run.estimates.push_back(estimate_at(1e-3 * i, std::log(30e3), -1));
  EXPECT_TRUE(score_belief(run).modulus.empty());
}

TEST(BeliefScore, ReportsWhenAContactWasReportedAndForHowLong) {
  log::RunLog run = run_with(1e-3F);
  for (int i = 0; i < 900; ++i) {
    run.estimates.push_back(estimate_at(0.003 + 1e-3 * i, 0, -1));
    if (i >= 600) run.estimates.back().unknown_contact_deviation = 0.02;
  }
  const BeliefScore score = score_belief(run);
  ASSERT_TRUE(score.first_contact);
  EXPECT_NEAR(*score.first_contact, 0.6, 1e-6);
  EXPECT_NEAR(score.contact_share, 1.0 / 3, 1e-9);
}

}  // namespace
}  // namespace palpate::scores
