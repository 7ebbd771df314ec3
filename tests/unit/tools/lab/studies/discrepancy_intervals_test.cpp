#include "tools/lab/studies/discrepancy_intervals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/math/constants.hpp"
#include "tests/unit/tools/lab/scores/synthetic_run.hpp"

namespace palpate::studies {
namespace {

using Eigen::Vector3d;

/// One of four nodes is off by 6 mm, the others by 3 mm; all report a deviation of 2 mm.
log::RunLog run_with_errors() {
  log::RunLog run = scores::synthetic_run([](const Vector3d& p, double) { return p; },
                                          [](const Vector3d& p, double) -> Vector3d {
                                            return p + Vector3d(p.x() > 0.35 ? 6e-3 : 3e-3, 0, 0);
                                          },
                                          2);
  for (shape_t& shape : run.shapes) {
    shape.deviation.assign(static_cast<std::size_t>(shape.node_count), 2e-3F);
    shape.deviation_count = shape.node_count;
  }
  return run;
}

/// A reaction that is off along x alone: by 0.1 N of a true 1 N in the first second, then by 0.4 N.
void add_wrenches(log::RunLog& run) {
  for (int i = 0; i < 200; ++i) {
    truth_contact_t truth{};
    truth.utime = 10000 * i;
    truth.grasp_count = 1;
    truth.grasp_wrench[0][0] = 1;
    run.truth_contacts.push_back(truth);
    estimate_t estimate{};
    estimate.utime = 10000 * i;
    estimate.grasp_count = 1;
    estimate.reaction[0][0] = i < 100 ? 0.9 : 0.6;
    for (double& deviation : estimate.reaction_deviation[0]) deviation = -1;
    estimate.reaction_deviation[0][0] = 0.1;
    estimate.log_young_modulus = std::log(33e3);
    estimate.log_young_modulus_deviation = 0.05;
    run.estimates.push_back(estimate);
  }
}

TEST(DiscrepancyIntervals, NodesArePooled) {
  const IntervalScore score =
      score_intervals(run_with_errors(), math::Pose::Identity(), 30e3, 1000000);
  EXPECT_EQ(score.nodes.covered(), 0.75);  // 5.6 mm
  EXPECT_NEAR(*score.nodes.normalised_square(), (3 * 0.75 + 3) / 4, 1e-5);
  EXPECT_NEAR(static_cast<double>(score.nodes.count()), 4 * 99, 8) << "of the second half alone";
  ASSERT_EQ(score.points.size(), 72u);
  EXPECT_EQ(score.points.front().errors.size(), 20u);
  EXPECT_NEAR(score.points.front().radii.front(), 5.591e-3, 1e-6);
  EXPECT_FALSE(score.log_young_error);
}

TEST(DiscrepancyIntervals, PointsAreThoseNextToFixedPlaces) {
  const IntervalScore score = score_intervals(run_with_errors(), math::Pose::Identity(), 30e3, 0);
  double at_end = 0, at_clamp = 0;
  for (const PointBelief& point : score.points) {
    if (point.place == Vector3d(1, 0, 0)) at_end = point.errors.front();
    if (point.place == Vector3d(0, 0, 0)) at_clamp = point.errors.front();
  }
  EXPECT_NEAR(at_end, 6e-3, 1e-6);
  EXPECT_NEAR(at_clamp, 3e-3, 1e-6);
  const auto json = to_json(score);
  EXPECT_EQ(json["points"].size(), 72u);
  EXPECT_EQ(json["points"][0]["error_mm"][0], 3.0);
  EXPECT_TRUE(json["log_young_modulus_error"].is_null());
}

TEST(DiscrepancyIntervals, OfWrenchAndModulus) {
  log::RunLog run = run_with_errors();
  add_wrenches(run);
  const IntervalScore score = score_intervals(run, math::Pose::Identity(), 30e3, 0);
  EXPECT_NEAR(score.wrench.share_inside, 0.5, 0.01);
  EXPECT_NEAR(score.wrench.normalised_square, (1 + 16) / 2.0, 0.1);
  EXPECT_NEAR(*score.log_young_error, std::log(1.1), 1e-9);
  EXPECT_EQ(score.log_young_deviation, 0.05);
}

}  // namespace
}  // namespace palpate::studies
