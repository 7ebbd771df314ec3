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
  return score_discrepancy(world, log, math::Pose::Identity());
}

TEST(DiscrepancyScore, TimesAreThoseOfTheLog) {
  const DiscrepancyScore score = scored(weight(1.9, 4), reporting_run());
  EXPECT_NEAR(*score.largest_passed, 2.3, 0.02);
  EXPECT_NEAR(*score.mean_passed, 2.3, 0.02);
  EXPECT_NEAR(score.largest_error, 0.01, 1e-5);
  EXPECT_NEAR(*score.reported, 2.5, 0.02);
  EXPECT_EQ(score.reason, "unexplained wrench");
  EXPECT_FALSE(score.false_report);
  EXPECT_NEAR(*score.recovered, 0.7, 0.02);  // below 3 mm at 4.7 s
  EXPECT_NEAR(*score.cleared, 1.5, 0.02);
}

TEST(DiscrepancyScore, CoverageIsOfTheTimeWithAndWithoutAReport) {
  const DiscrepancyScore score = scored(weight(1.9, 4), reporting_run());
  EXPECT_EQ(score.covered, 1.0);             // 10 mm within 28 mm
  EXPECT_EQ(score.covered_unreported, 0.0);  // more than 3 mm, but 2.8 mm reported
}

TEST(DiscrepancyScore, AReportWithoutADiscrepancyIsFalse) {
  DiscrepancyWorld none;
  none.kind = "none";
  const DiscrepancyScore score = scored(none, reporting_run());
  EXPECT_TRUE(score.false_report);
  EXPECT_FALSE(score.onset);
  EXPECT_FALSE(score.reported);
  EXPECT_TRUE(score.largest_passed) << "the error itself is still counted";
  // One that ends before the onset is false as well, and not that of the discrepancy.
  const DiscrepancyScore late = scored(weight(5.6, 5.9), reporting_run());
  EXPECT_TRUE(late.false_report);
  EXPECT_FALSE(late.reported);
  EXPECT_FALSE(late.largest_passed);
}

TEST(DiscrepancyScore, AReportThatLastsAtTheOnsetCountsFromIt) {
  const DiscrepancyScore score = scored(weight(3, 4), reporting_run());
  EXPECT_FALSE(score.false_report);
  EXPECT_NEAR(*score.reported, 3, 1e-6);
}

TEST(DiscrepancyScore, WhatNeverHappensIsEmpty) {
  log::RunLog run = reporting_run();
  for (estimate_t& estimate : run.estimates) estimate.status = estimate_t::STATUS_OK;
  const DiscrepancyScore silent = scored(weight(1.9, 4), run);
  EXPECT_FALSE(silent.reported);
  EXPECT_FALSE(silent.covered);
  EXPECT_NEAR(*silent.covered_unreported, 2.2 / 2.4, 0.01);  // the deviations are as wide as before
  const DiscrepancyScore stays = scored(weight(1.9, HUGE_VAL), reporting_run());
  EXPECT_FALSE(stays.end);
  EXPECT_FALSE(stays.recovered);
  EXPECT_TRUE(to_json(stays)["recovered_s"].is_null());
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
  EXPECT_TRUE(never.false_report);
}

}  // namespace
}  // namespace palpate::studies
