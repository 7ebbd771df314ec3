#include "tools/lab/scores/feature_score.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/math/rigid.hpp"
#include "tests/unit/tools/lab/scores/synthetic_run.hpp"

namespace palpate::scores {
namespace {

FeatureErrorSample at(double time, double x) {
  FeatureErrorSample sample;
  sample.time = time;
  sample.position = {x, 0, 0};
  sample.distance = std::abs(0.1 - x);
  return sample;
}

TEST(FeatureScore, TimeIsThatOfTheLastEntryIntoTheBand) {
  const std::vector<FeatureErrorSample> samples{at(0, 0), at(1, 0.098), at(2, 0.11), at(3, 0.102),
                                                at(4, 0.099)};
  EXPECT_EQ(time_to_stay_within(samples, 5e-3, 1), 3.0);
  EXPECT_EQ(time_to_stay_within(samples, 1.5e-3, 1), 4.0);
  EXPECT_EQ(time_to_stay_within(samples, 0.5e-3, 1), std::nullopt);
}

TEST(FeatureScore, AnAngleOutsideItsBandCountsToo) {
  std::vector<FeatureErrorSample> samples{at(0, 0.1), at(1, 0.1), at(2, 0.1)};
  samples[1].angle = 0.1;
  EXPECT_EQ(time_to_stay_within(samples, 5e-3, 0.05), 2.0);
}

TEST(FeatureScore, OvershootIsAPartOfTheWay) {
  const std::vector<FeatureErrorSample> samples{at(0, 0), at(1, 0.12), at(2, 0.1)};
  EXPECT_NEAR(overshoot(samples, {0.1, 0, 0}), 0.2, 1e-12);
  EXPECT_EQ(overshoot({at(0, 0), at(1, 0.09)}, {0.1, 0, 0}), 0.0);
}

shape_target_t target_of(const char* kind, const std::vector<Eigen::Vector3d>& points,
                         const std::vector<double>& values, double time) {
  shape_target_t target = {};
  target.utime = static_cast<std::int64_t>(time * 1e6);
  target.revision = 1;
  std::strcpy(reinterpret_cast<char*>(target.kind), kind);
  target.point_count = static_cast<int>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) target.rest_points[i][axis] = points[i][axis];
  target.value_count = static_cast<int>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) target.values[i] = values[i];
  return target;
}

TEST(FeatureScore, PointFollowsThePlantAndNotTheEstimate) {
  // The plant approaches 0.1 m with a time constant of 1 s from t = 1 s on; the estimate stands
  // still.
  const auto truth = [](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
    return p + Eigen::Vector3d(0, 0, t < 1 ? 0 : 0.1 * (1 - std::exp(1 - t)));
  };
  const auto estimate = [](const Eigen::Vector3d& p, double) -> Eigen::Vector3d { return p; };
  log::RunLog run = synthetic_run(truth, estimate, 9);
  const Eigen::Vector3d point(0.13, 0.04, 0.2);
  run.targets.push_back(target_of("point", {point}, {0.13, 0.04, 0.3}, 1));
  run.targets.push_back(target_of("point", {point}, {0.13, 0.04, 0.3}, 1.5));
  const auto score = score_feature(run);
  ASSERT_TRUE(score);
  EXPECT_NEAR(score->start_distance, 0.1, 1e-6);
  ASSERT_TRUE(score->within_5mm && score->within_1mm);
  EXPECT_NEAR(*score->within_5mm, std::log(20.0), 0.011);
  EXPECT_NEAR(*score->within_1mm, std::log(100.0), 0.011);
  EXPECT_NEAR(score->path, 0.1, 1e-3);
  EXPECT_EQ(score->overshoot, 0);
}

TEST(FeatureScore, PoseErrorHasItsAngle) {
  const double angle = 0.03;
  const auto truth = [angle](const Eigen::Vector3d& p, double) -> Eigen::Vector3d {
    return math::exp_rotation(Eigen::Vector3d(0, 0, angle)) * p;
  };
  log::RunLog run = synthetic_run(truth, truth, 1);
  const std::vector<Eigen::Vector3d> points{{0.1, 0, 0}, {0.3, 0, 0}, {0.1, 0.1, 0}};
  // At rest: x along the bar, z up.
  run.targets.push_back(target_of("pose", points, {0.5 / 3, 0.1 / 3, 0, 1, 0, 0, 0}, 0));
  const auto score = score_feature(run);
  ASSERT_TRUE(score);
  EXPECT_NEAR(score->rest_angle, angle, 1e-6);
  EXPECT_NEAR(score->rest_distance, 2 * std::sin(angle / 2) * std::hypot(0.5 / 3, 0.1 / 3), 1e-6);
  EXPECT_FALSE(score->within_5mm);
}

TEST(FeatureScore, ErrorOfASetIsItsRootMeanSquare) {
  // The plant stretches along x by a tenth; the target is the rest shape.
  const auto truth = [](const Eigen::Vector3d& p, double) -> Eigen::Vector3d {
    return {1.1 * p.x(), p.y(), p.z()};
  };
  log::RunLog run = synthetic_run(truth, truth, 1);
  std::vector<Eigen::Vector3d> points;
  std::vector<double> values;
  double sum = 0;
  for (int i = 0; i < 20; ++i) {
    points.emplace_back(0.02 * (i + 1), 0.05, 0.1 + 0.005 * i);
    values.insert(values.end(), points.back().begin(), points.back().end());
    sum += std::pow(0.1 * points.back().x(), 2);
  }
  run.targets.push_back(target_of("points", points, values, 0));
  feature_t seen = {};  // holds ten points and a third of another
  seen.revision = 1;
  seen.value_count = seen.error_count = 32;
  for (int i = 0; i < 32; ++i) seen.error[i] = i < 30 ? 0.003 : 7;
  seen.unreachable[1] = 0.002;
  run.features.push_back(seen);
  const auto score = score_feature(run);
  ASSERT_TRUE(score);
  EXPECT_NEAR(score->rest_distance, std::sqrt(sum / 20), 1e-6);
  EXPECT_NEAR(score->rest_largest, 0.04, 1e-6);
  EXPECT_EQ(score->rest_angle, 0);
  EXPECT_NEAR(score->estimated_distance, 0.003 * std::sqrt(3), 1e-12);
  EXPECT_NEAR(score->unreachable, 0.002 / std::sqrt(10), 1e-12);
}

TEST(FeatureScore, OfADistanceIsItsDifference) {
  const auto truth = [](const Eigen::Vector3d& p, double) -> Eigen::Vector3d {
    return {1.1 * p.x(), p.y(), p.z()};
  };
  log::RunLog run = synthetic_run(truth, truth, 1);
  run.targets.push_back(target_of("distance", {{0.1, 0, 0}, {0.3, 0, 0}}, {0.21}, 0));
  const auto score = score_feature(run);
  ASSERT_TRUE(score);
  EXPECT_NEAR(score->rest_distance, 0.01, 1e-6);
  EXPECT_EQ(score->rest_angle, 0);
}

/// A bar bent about -y to a circle of this radius, its line x = 0 to y of the circle's lowest
/// point.
auto bent_to(double radius) {
  return [radius](const Eigen::Vector3d& p, double) -> Eigen::Vector3d {
    const double angle = p.x() / radius, r = radius - p.z();
    return {r * std::sin(angle), p.y(), radius - r * std::cos(angle)};
  };
}

runs::FeatureDefinition about_minus_y(const char* kind) {
  runs::FeatureDefinition steered;
  steered.kind = kind;
  steered.axis = Eigen::Vector3d(0, -1, 0);
  return steered;
}

TEST(FeatureScore, OfACurvatureIsInItsOwnUnit) {
  log::RunLog run = synthetic_run(bent_to(2), bent_to(2), 1);
  const std::vector<Eigen::Vector3d> points{{0.1, 0, 0}, {0.2, 0, 0}, {0.3, 0, 0}};
  run.targets.push_back(target_of("curvature", points, {0.6}, 0));
  EXPECT_THROW(score_feature(run), std::invalid_argument) << "a straight line without an axis";
  const runs::FeatureDefinition steered = about_minus_y("curvature");
  const auto score = score_feature(run, &steered);
  ASSERT_TRUE(score);
  EXPECT_FALSE(score->is_distance);
  EXPECT_NEAR(score->rest_size, 0.1, 2e-3);
  EXPECT_NEAR(score->start_size, score->rest_size, 1e-12) << "nothing moves";
  EXPECT_EQ(score->rest_distance, 0);
  EXPECT_EQ(score->rest_angle, 0);
  EXPECT_FALSE(score->within_twentieth);
}

TEST(FeatureScore, OfAnAngleIsAnAngle) {
  log::RunLog run = synthetic_run(bent_to(2), bent_to(2), 1);
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {0.1, 0, 0}, {0.3, 0, 0}, {0.4, 0, 0}};
  run.targets.push_back(target_of("angle", points, {0.2}, 0));
  const runs::FeatureDefinition steered = about_minus_y("angle");
  const auto score = score_feature(run, &steered);
  ASSERT_TRUE(score);
  EXPECT_FALSE(score->is_distance);
  EXPECT_NEAR(score->rest_angle, 0.2 - 0.15, 1e-3) << "from the middle of one to that of the other";
  EXPECT_EQ(score->rest_size, score->rest_angle);
}

// Under a translation the contour's error equals that of each of its points.
TEST(FeatureScore, OfAContourIsTheMeanOverItsLength) {
  const Eigen::Vector3d shift(0.003, -0.002, 0.006);
  const auto truth = [&shift](const Eigen::Vector3d& p, double t) -> Eigen::Vector3d {
    return t < 0.5 ? p : p + shift;
  };
  log::RunLog run = synthetic_run(truth, truth, 2);
  runs::FeatureDefinition steered;
  steered.kind = "fourier_contour";
  steered.harmonics = 2;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2 * M_PI * i / 12;
    steered.rest_points.emplace_back(0.2 + 0.1 * std::cos(angle), 0.05 + 0.04 * std::sin(angle), 0);
  }
  const runs::FeatureOnPoints contour(steered);
  const Eigen::VectorXd rest = contour.value(contour.rest_points());
  run.targets.push_back(target_of("fourier_contour", steered.rest_points,
                                  {rest.data(), rest.data() + rest.size()}, 0));
  const auto score = score_feature(run, &steered);
  ASSERT_TRUE(score);
  EXPECT_TRUE(score->is_distance);
  EXPECT_NEAR(score->rest_distance, shift.norm(), 1e-6);
  EXPECT_NEAR((score->samples.back().position - score->samples.front().position - shift).norm(), 0,
              1e-6);

  // Of one harmonic alone the mean square over the contour is half that of its amplitude.
  Eigen::VectorXd wave = Eigen::VectorXd::Zero(rest.size());
  wave[1] = 0.004;
  EXPECT_NEAR(contour.distance(wave), 0.004 / std::sqrt(2), 1e-12);
}

TEST(FeatureScore, NoTargetNoScore) {
  const auto rest = [](const Eigen::Vector3d& p, double) -> Eigen::Vector3d { return p; };
  EXPECT_FALSE(score_feature(synthetic_run(rest, rest, 1)));
}

}  // namespace
}  // namespace palpate::scores
