#include "tools/lab/scores/shape_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/tools/lab/scores/synthetic_run.hpp"

namespace palpate::scores {
namespace {

Eigen::Vector3d drift(const Eigen::Vector3d& p, double time) {
  return p + Eigen::Vector3d(0, 0.1 * time, 0);
}

TEST(ShapeScore, KnownErrorGivesThatNumber) {
  const Eigen::Vector3d offset(0.001, -0.002, 0.002);  // 3 mm
  const log::RunLog run = synthetic_run(
      drift,
      [&](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d { return drift(p, t) + offset; },
      2);
  const ShapeScore score = score_shape(run);
  EXPECT_NEAR(score.length, 0.4, 1e-6);
  EXPECT_NEAR(score.whole.mean, 3e-3, 1e-6);
  EXPECT_NEAR(score.whole.rms, 3e-3, 1e-6);
  EXPECT_NEAR(score.whole.maximum, 3e-3, 1e-6);
  EXPECT_NEAR(score.largest_displacement, 0.2, 2e-3);
}

TEST(ShapeScore, MeanRmsAndMaximumDifferAsTheyShould) {
  // One node of four is off by 8 mm.
  const log::RunLog run = synthetic_run(
      drift,
      [](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
        return drift(p, t) + Eigen::Vector3d(p.x() > 0.35 ? 8e-3 : 0, 0, 0);
      },
      1);
  const ShapeScore score = score_shape(run);
  EXPECT_NEAR(score.whole.mean, 2e-3, 1e-6);
  EXPECT_NEAR(score.whole.rms, 4e-3, 1e-6);
  EXPECT_NEAR(score.whole.maximum, 8e-3, 1e-6);
}

/// Rest, ramp to 50 mm from 2 s to 3 s, rest to 5 s, ramp back, rest to 8 s.
double height(double time) {
  return 0.05 * (std::clamp(time - 2, 0.0, 1.0) - std::clamp(time - 5, 0.0, 1.0));
}

std::vector<truth_contact_t> ramped_contacts() {
  std::vector<truth_contact_t> contacts;
  for (double time = 0; time < 8; time += 0.01) {
    truth_contact_t contact = {};
    contact.utime = static_cast<std::int64_t>(time * 1e6 + 0.5);
    contact.grasp_count = 1;
    contact.grasp_position[0][2] = height(time);
    contact.grasp_quaternion[0][0] = 1;
    contacts.push_back(contact);
  }
  return contacts;
}

TEST(ShapeScore, HoldsAreFoundBetweenMotions) {
  const std::vector<Interval> holds = find_holds(ramped_contacts(), 1.0);
  ASSERT_EQ(holds.size(), 3u);
  EXPECT_NEAR(holds[1].begin * 1e-6, 3.0, 0.15);
  EXPECT_NEAR(holds[1].end * 1e-6, 5.0, 0.15);
  EXPECT_TRUE(find_holds(ramped_contacts(), 2.5).empty());
}

TEST(ShapeScore, HoldsAreScoredAtTheirEnd) {
  const auto truth = [](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
    return p + Eigen::Vector3d(0, 0, height(t));
  };
  // The error is 10 mm at the start of a pose, 2 mm in its last half second and 1 mm in the second
  // pose.
  const auto estimate = [&](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
    const double error = t < 4 ? 10e-3 : t < 6 ? 2e-3 : 1e-3;
    return truth(p, t) + Eigen::Vector3d(error, 0, 0);
  };
  log::RunLog run = synthetic_run(truth, estimate, 8);
  run.truth_contacts = ramped_contacts();
  const ShapeScore score = score_shape(run);
  ASSERT_EQ(score.holds.size(), 2u);
  EXPECT_NEAR(score.holds[0].error.mean, 2e-3, 1e-5);
  EXPECT_NEAR(score.holds[1].error.mean, 1e-3, 1e-5);
  EXPECT_NEAR(score.at_holds().mean, 1.5e-3, 1e-5);
  EXPECT_NEAR(score.median_hold(), 1.5e-3, 1e-5);
  EXPECT_NEAR(score.at_holds().maximum, 2e-3, 1e-5);
  EXPECT_NEAR(score.whole.maximum, 10e-3, 1e-5);
  // 2 s of motion with 10 mm, 1 s with 2 mm, 1 s with 1 mm.
  EXPECT_NEAR(score.in_motion.mean, 5.75e-3, 0.4e-3);
}

TEST(ShapeScore, MissingTruthAndNumbersThatAreNoneAreRefused) {
  log::RunLog run = synthetic_run(drift, drift, 1);
  run.shapes[5].xyz[0] = std::nanf("");
  EXPECT_THROW(score_shape(run), std::runtime_error);
  run = synthetic_run(drift, drift, 1);
  run.truths.clear();
  EXPECT_THROW(score_shape(run), std::runtime_error);
}

}  // namespace
}  // namespace palpate::scores
