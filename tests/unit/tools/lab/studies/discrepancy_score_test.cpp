#include "tools/lab/studies/discrepancy_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/unit/tools/lab/scores/synthetic_run.hpp"

namespace palpate::studies {
namespace {

using Eigen::Vector3d;

constexpr double kSeconds = 6;

Vector3d at_rest(const Vector3d& p, double) { return p; }

/// The estimate is off by 10 mm/s from 2 s to 3 s and returns from 4 s to 5 s.
Vector3d wrong(const Vector3d& p, double time) {
  const double error = time < 2   ? 0
                       : time < 3 ? 0.01 * (time - 2)
                       : time < 4 ? 0.01
                       : time < 5 ? 0.01 * (5 - time)
                                  : 0;
  return p + Vector3d(0, error, 0);
}

/// Reports from 2.5 s to 5.5 s, with standard deviations of 10 mm there and 1 mm elsewhere.
log::RunLog reporting_run(const scores::Deformation& truth = at_rest) {
  log::RunLog run = scores::synthetic_run(truth, wrong, kSeconds);
  const auto is_reported = [](double time) { return time >= 2.5 && time < 5.5; };
  for (shape_t& shape : run.shapes) {
    shape.deviation_count = shape.node_count;
    shape.deviation.assign(shape.node_count, is_reported(1e-6 * shape.utime) ? 0.01F : 0.001F);
  }
  for (int i = 0; i < 100 * static_cast<int>(kSeconds); ++i) {
    estimate_t estimate{};
    estimate.utime = 10000 * i;
    estimate.unknown_contact_deviation = -1;
    if (is_reported(0.01 * i)) estimate.status = estimate_t::STATUS_DEGRADED;
    run.estimates.push_back(estimate);
    if (i % 10 != 0) continue;
    health_t health{};
    health.utime = estimate.utime;
    health.state = health_t::STATE_ACTIVE;
    if (is_reported(0.01 * i)) health.state = health_t::STATE_DEGRADED;
    std::strcpy(reinterpret_cast<char*>(health.reason), "unexplained wrench");
    run.health.push_back(health);
  }
  return run;
}

DiscrepancyWorld weight(double onset, double end) {
  DiscrepancyWorld world;
  world.kind = "weight";
  world.onset = onset;
  world.end = end;
  return world;
}

DiscrepancyScore scored(const DiscrepancyWorld& world, const log::RunLog& log) {
  return score_discrepancy(world, log, {}, math::Pose::Identity());
}

std::int64_t us(double seconds) { return std::llround(1e6 * seconds); }

/// DISCREPANCY twenty times a second, of one hand, with a difference of `significance(time)`
/// deviations along y.
template <class Significance>
std::vector<discrepancy_t> discrepancies(const Significance& significance) {
  std::vector<discrepancy_t> messages;
  for (double time = 0.02; time < kSeconds; time += 0.05) {
    discrepancy_t message{};
    message.utime = us(time);
    message.grasp_count = 1;
    message.test = 3 * significance(time);
    message.threshold = 6;
    for (double& deviation : message.deviation[0]) deviation = 0.5;
    message.deviation[0][5] = -1;   // not available
    message.difference[0][5] = 99;  // and not counted
    message.difference[0][1] = -0.5 * significance(time);
    messages.push_back(message);
  }
  return messages;
}

TEST(DiscrepancyScore, TimesAreThoseOfTheLog) {
  const DiscrepancyScore score = scored(weight(1.9, 4), reporting_run());
  EXPECT_NEAR(*score.largest_passed, 2.3, 0.02);
  EXPECT_NEAR(*score.mean_passed, 2.3, 0.02);
  EXPECT_NEAR(score.largest_error, 0.01, 1e-5);
  EXPECT_NEAR(*score.reported, 2.5, 0.02);
  EXPECT_EQ(score.reason, "unexplained wrench");
  EXPECT_EQ(score.false_reports, 0);
  EXPECT_NEAR(*score.recovered, 0.7, 0.02);  // below 3 mm at 4.7 s
  EXPECT_NEAR(*score.cleared, 1.5, 0.02);
}

TEST(DiscrepancyScore, CoverageIsOfTheTimeWithAndWithoutAReport) {
  const DiscrepancyScore score = scored(weight(1.9, 4), reporting_run());
  EXPECT_EQ(score.reported_belief.covered(), 1.0);    // 10 mm within 28 mm
  EXPECT_EQ(score.unreported_belief.covered(), 0.0);  // more than 3 mm, but 2.8 mm reported
}

TEST(DiscrepancyScore, AReportWithoutADiscrepancyIsFalse) {
  DiscrepancyWorld none;
  none.kind = "none";
  const DiscrepancyScore score = scored(none, reporting_run());
  EXPECT_EQ(score.false_reports, 1);
  EXPECT_FALSE(score.onset);
  EXPECT_FALSE(score.reported);
  EXPECT_TRUE(score.largest_passed) << "the error itself is still counted";
  // One that ends before the onset is false as well, and not that of the discrepancy.
  const DiscrepancyScore late = scored(weight(5.6, 5.9), reporting_run());
  EXPECT_EQ(late.false_reports, 1);
  EXPECT_FALSE(late.reported);
  EXPECT_FALSE(late.largest_passed);
}

TEST(DiscrepancyScore, AReportThatLastsAtTheOnsetCountsFromIt) {
  const DiscrepancyScore score = scored(weight(3, 4), reporting_run());
  EXPECT_EQ(score.false_reports, 0);
  EXPECT_NEAR(*score.reported, 3, 1e-6);
}

TEST(DiscrepancyScore, WhatNeverHappensIsEmpty) {
  log::RunLog run = reporting_run();
  for (estimate_t& estimate : run.estimates) estimate.status = estimate_t::STATUS_OK;
  const DiscrepancyScore silent = scored(weight(1.9, 4), run);
  EXPECT_FALSE(silent.reported);
  EXPECT_FALSE(silent.reported_belief.covered());
  EXPECT_NEAR(*silent.unreported_belief.covered(), 2.2 / 2.4,
              0.01);  // the deviations are as wide as before
  const DiscrepancyScore stays = scored(weight(1.9, HUGE_VAL), reporting_run());
  EXPECT_FALSE(stays.end);
  EXPECT_FALSE(stays.recovered);
  EXPECT_TRUE(to_json(stays, 0)["recovered_s"].is_null());
  run.truths.clear();
  EXPECT_THROW(scored(weight(1, 2), run), std::runtime_error);
}

TEST(DiscrepancyScore, AnObstacleBeginsWhenTheyTouch) {
  // The plant sinks by 20 mm/s from 1 s to 2 s and rises from 3 s to 4 s; the table is 10 mm below.
  const auto sinking = [](const Vector3d& p, double time) -> Vector3d {
    const double depth = std::clamp(time - 1, 0.0, 1.0) - std::clamp(time - 3, 0.0, 1.0);
    return p - Vector3d(0, 0, 0.02 * depth);
  };
  DiscrepancyWorld world;
  world.kind = "table";
  world.obstacle = RigidObstacle{{0, 0, -0.01}, Vector3d::UnitZ(), 0};
  const DiscrepancyScore score = scored(world, reporting_run(sinking));
  EXPECT_NEAR(*score.onset, 1.49, 0.02);
  EXPECT_NEAR(*score.end, 3.51, 0.02);
  world.obstacle->point.z() = -1;
  const DiscrepancyScore never = scored(world, reporting_run(sinking));
  EXPECT_FALSE(never.onset);
  EXPECT_EQ(never.false_reports, 1);
}

TEST(DiscrepancyScore, AnObstacleMayTouchBetweenNodes) {
  // The plant's nodes are 0.2 m apart along x; a thin cylinder along y lies 10 mm below, between.
  const auto sinking = [](const Vector3d& p, double time) -> Vector3d {
    return p - Vector3d(0, 0, 0.02 * std::clamp(time - 1, 0.0, 1.0));
  };
  DiscrepancyWorld world;
  world.kind = "cylinder";
  world.obstacle = RigidObstacle{{0.1, 0, -0.03}, Vector3d::UnitY(), 0.02};
  const DiscrepancyScore score = scored(world, reporting_run(sinking));
  EXPECT_NEAR(*score.onset, 1.49, 0.02);
  EXPECT_FALSE(score.end) << "it stays";
}

TEST(DiscrepancyScore, ReportsBeforeTheMotionBeginsDoNotCount) {
  DiscrepancyWorld none;
  none.kind = "none";
  none.begin = 5.6;
  EXPECT_EQ(scored(none, reporting_run()).false_reports, 0);
  none.begin = 5;
  const DiscrepancyScore score = scored(none, reporting_run());
  EXPECT_EQ(score.false_reports, 1);
  EXPECT_EQ(score.reports.at(0).begin, us(5));
  EXPECT_NEAR(to_json(score, 0)["free_air_s"].get<double>(), kSeconds - 5, 0.03);
}

TEST(DiscrepancyScore, TestsHoldErrorAndSignificanceSinceTheMotionBegan) {
  log::RunLog run = reporting_run();
  run.discrepancies = discrepancies([](double time) { return time < 2.5 ? 1.0 : 7.0; });
  DiscrepancyWorld world = weight(1.9, 4);
  world.begin = 1;
  const DiscrepancyScore score = scored(world, run);
  ASSERT_FALSE(score.tests.empty());
  EXPECT_NEAR(score.tests.front().time, 1.02, 0.051);
  for (const TestedWrench& test : score.tests) {
    EXPECT_NEAR(test.significance, test.time < 2.5 ? 1 : 7, 1e-9) << test.time;
    EXPECT_NEAR(test.of_threshold, test.time < 2.5 ? 0.5 : 3.5, 1e-6) << test.time;
    if (test.time > 3.1 && test.time < 3.9) {
      EXPECT_NEAR(test.largest_error, 0.01, 1e-5);
    }
  }
  EXPECT_EQ(to_json(score, 0)["tests"]["time_s"].size(), score.tests.size());
  EXPECT_TRUE(scored(weight(1.9, 4), reporting_run()).tests.empty()) << "no DISCREPANCY";
}

TEST(DiscrepancyScore, RankingsAreThoseAfterTheReportAndAtTheEnd) {
  log::RunLog run = reporting_run();  // reports from 2.5 s on
  run.discrepancies = discrepancies([](double) { return 1; });
  for (discrepancy_t& message : run.discrepancies) {
    if (message.utime < us(3)) continue;
    message.cause_count = 2;
    message.cause[0] = discrepancy_t::CAUSE_SLIP;
    if (message.utime > us(4.6)) message.cause[0] = discrepancy_t::CAUSE_WEIGHT;
    message.cause[1] = discrepancy_t::CAUSE_CONTACT;
  }
  const DiscrepancyScore score = scored(weight(1.9, 5), run);
  EXPECT_EQ(score.early_ranking,
            (std::vector<int>{discrepancy_t::CAUSE_SLIP, discrepancy_t::CAUSE_CONTACT}));
  EXPECT_EQ(score.late_ranking.at(0), discrepancy_t::CAUSE_WEIGHT);
  const auto json = to_json(score, 0);
  EXPECT_EQ(json["ranking_at_the_end"].dump(), R"(["weight","contact"])");
  // An explanation that corrects the estimate has ended the discrepancy.
  for (discrepancy_t& message : run.discrepancies)
    if (message.utime > us(4.8)) message.adopted = discrepancy_t::CAUSE_SLIP;
  EXPECT_EQ(scored(weight(1.9, 5), run).late_ranking, std::vector<int>{discrepancy_t::CAUSE_SLIP});
}

TEST(DiscrepancyScore, RecoveryIsComparedWithPoseAlone) {
  // The weight ends at 4 s; the estimate returns until 5 s, pose alone is right from 4.2 s on.
  const scores::Deformation pose_error = [](const Vector3d& p, double time) -> Vector3d {
    return p + Vector3d(0, time < 4.2 ? 0.02 : 0, 0);
  };
  log::RunLog by_pose = scores::synthetic_run(at_rest, pose_error, kSeconds);
  const auto pose = shape_errors(by_pose, math::Pose::Identity());
  const DiscrepancyScore score =
      score_discrepancy(weight(1.9, 4), reporting_run(), pose, math::Pose::Identity());
  EXPECT_NEAR(*score.reached_pose_alone, 0, 0.02);
  EXPECT_NEAR(*score.stays_at_pose_alone, 0.99, 0.02);  // 0.1 mm at 4.99 s
  EXPECT_NEAR(*score.average_of_pose_alone, 0.02 * 4.2 / kSeconds, 2e-4);
  EXPECT_NEAR(score.average_error, 0.02 / kSeconds, 1e-4);
  EXPECT_FALSE(scored(weight(1.9, 4), reporting_run()).reached_pose_alone) << "nothing to compare";
}

}  // namespace
}  // namespace palpate::studies
