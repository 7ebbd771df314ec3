#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/shape/point_features.hpp"
#include "core/shape/pose_feature.hpp"
#include "tests/unit/core/shape/shapes.hpp"

namespace palpate::shape {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

PoseFeature::Options pose_points() {
  return {{Vector3d(0.40, 0.01, 0.02), Vector3d(0.47, 0.03, 0.05), Vector3d(0.43, 0.055, 0.01)}};
}

/// Some inside, one on a node.
PointsFeature::Options set_of_points() {
  return {{{0.31, 0.02, 0.04}, {0.5, 0.06, 0.06}, {0.05, 0.06, 0.031}, {0.32, 0.02, 0.04}}};
}

class FeatureTest : public ::testing::TestWithParam<mesh::ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Orders, FeatureTest,
                         ::testing::Values(mesh::ElementOrder::kLinear,
                                           mesh::ElementOrder::kQuadratic));

TEST_P(FeatureTest, PointAtRestIsItsRestPoint) {
  const mesh::ElementMesh mesh = bar(GetParam());
  PointFeature feature(mesh, {{0.31, 0.02, 0.04}, {0, 1, 2}});
  VectorXd value(3);
  feature.evaluate(mesh.nodes, value);
  EXPECT_LT((value - Vector3d(0.31, 0.02, 0.04)).norm(), 1e-12);
}

TEST_P(FeatureTest, JacobiansEqualCentralDifferences) {
  const mesh::ElementMesh mesh = bar(GetParam());
  PointFeature point(mesh, {{0.31, 0.02, 0.04}, {2, 0}});
  PoseFeature pose(mesh, pose_points());
  PointsFeature points(mesh, set_of_points());
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_LT(jacobian_error(point, deformed(mesh, seed)), 1e-7);
    EXPECT_LT(jacobian_error(pose, deformed(mesh, seed)), 1e-7);
    EXPECT_LT(jacobian_error(points, deformed(mesh, seed)), 1e-7);
  }
}

TEST_P(FeatureTest, PoseMovesWithARigidMotion) {
  const mesh::ElementMesh mesh = bar(GetParam());
  PoseFeature feature(mesh, pose_points());
  VectorXd before(7), after(7);
  feature.evaluate(mesh.nodes, before);
  const math::Pose X =
      math::make_pose(math::exp_rotation({1.1, -0.7, 2.0}), Vector3d(0.3, -0.2, 0.1));
  feature.evaluate((X.linear() * mesh.nodes).colwise() + X.translation(), after);
  EXPECT_LT((after.head<3>() - X * Vector3d(before.head<3>())).norm(), 1e-12);
  const Eigen::Matrix3d R = math::rotation_from_wxyz(before.data() + 3);
  EXPECT_LT((math::rotation_from_wxyz(after.data() + 3) - X.linear() * R).norm(), 1e-12);
}

TEST(PointFeature, ControlsOnlyItsComponents) {
  PointFeature feature(bar(mesh::ElementOrder::kLinear), {{0.3, 0.03, 0.03}, {2}});
  EXPECT_EQ(feature.dimension(), 1);
  EXPECT_EQ(feature.value_count(), 3);
  VectorXd error(1);
  feature.error(Vector3d(1, 2, 3), Vector3d(7, 8, 3.5), error);
  EXPECT_DOUBLE_EQ(error[0], 0.5);
  EXPECT_NEAR(feature.jacobian().sum(), 1, 1e-12);  // shape functions sum to one
}

TEST(PointFeature, RefusesBadSetUp) {
  const mesh::ElementMesh mesh = bar(mesh::ElementOrder::kLinear);
  EXPECT_THROW(PointFeature(mesh, {{0.502, 0.03, 0.03}, {0, 1, 2}}), std::invalid_argument);
  EXPECT_NO_THROW(PointFeature(mesh, {{0.5005, 0.03, 0.03}, {0, 1, 2}}));
  EXPECT_THROW(PointFeature(mesh, {{kNan, 0.03, 0.03}, {0, 1, 2}}), std::invalid_argument);
  EXPECT_THROW(PointFeature(mesh, {{0.3, 0.03, 0.03}, {}}), std::invalid_argument);
  EXPECT_THROW(PointFeature(mesh, {{0.3, 0.03, 0.03}, {1, 1}}), std::invalid_argument);
  EXPECT_THROW(PointFeature(mesh, {{0.3, 0.03, 0.03}, {3}}), std::invalid_argument);
}

TEST(PointFeature, ChecksTargets) {
  const PointFeature feature(bar(mesh::ElementOrder::kLinear), {{0.3, 0.03, 0.03}, {2}});
  const double good[] = {0, 0, 0};
  const double bad[] = {0, kNan, 0};
  EXPECT_TRUE(feature.is_valid_target(good, 3));
  EXPECT_FALSE(feature.is_valid_target(good, 2));
  EXPECT_FALSE(feature.is_valid_target(bad, 3));
}

TEST_P(FeatureTest, PointsAreTheirPointsOneAfterTheOther) {
  const mesh::ElementMesh mesh = bar(GetParam());
  const PointsFeature::Options options = set_of_points();
  PointsFeature points(mesh, options);
  ASSERT_EQ(points.dimension(), 12);
  const Eigen::Matrix3Xd x = deformed(mesh);
  VectorXd all(12), one(3);
  points.evaluate(x, all);
  for (std::size_t i = 0; i < options.rest_points.size(); ++i) {
    PointFeature point(mesh, {options.rest_points[i], {0, 1, 2}});
    point.evaluate(x, one);
    EXPECT_EQ(VectorXd(all.segment<3>(3 * static_cast<int>(i))), one);
  }
}

TEST(PointsFeature, HoldsTheSurfaceOfABar) {
  const mesh::ElementMesh mesh = bar(mesh::ElementOrder::kQuadratic);
  PointsFeature::Options options;
  for (int i = 0; i < 16; ++i) {
    const double x = 0.5 * (i + 1) / 16;
    options.rest_points.insert(options.rest_points.end(),
                               {{x, 0, 0}, {x, 0.06, 0}, {x, 0, 0.06}, {x, 0.06, 0.06}});
  }
  PointsFeature feature(mesh, options);
  EXPECT_EQ(feature.dimension(), 192);
  VectorXd value(192), error(192);
  feature.evaluate(mesh.nodes, value);
  feature.error(value, value.array() + 0.01, error);
  EXPECT_LT((error.array() - 0.01).abs().maxCoeff(), 1e-15);
  // A point is a sum of at most the ten nodes of its element.
  EXPECT_LE(feature.jacobian().nonZeros(), 192 * 10);
  options.rest_points.resize(PointsFeature::kMostPoints + 1, {0.25, 0.03, 0.06});
  EXPECT_THROW(PointsFeature(mesh, options), std::invalid_argument);
}

TEST(PointsFeature, RefusesBadSetUpAndTargets) {
  const mesh::ElementMesh mesh = bar(mesh::ElementOrder::kLinear);
  using Options = PointsFeature::Options;
  EXPECT_THROW(PointsFeature(mesh, Options{}), std::invalid_argument);
  EXPECT_THROW(PointsFeature(mesh, Options{{{0.3, 0.03, 0.03}, {0.3, 0.0305, 0.03}}}),
               std::invalid_argument);
  EXPECT_THROW(PointsFeature(mesh, Options{{{0.3, 0.03, 0.03}, {0.3, 0.03, 0.3}}}),
               std::invalid_argument);
  const PointsFeature feature(mesh, Options{{{0.3, 0.03, 0.03}, {0.4, 0.03, 0.03}}});
  const double good[] = {0, 0, 0, 1, 1, 1};
  const double bad[] = {0, 0, 0, 1, 1, kNan};
  EXPECT_TRUE(feature.is_valid_target(good, 6));
  EXPECT_FALSE(feature.is_valid_target(good, 3));
  EXPECT_FALSE(feature.is_valid_target(bad, 6));
}

TEST(PoseFeature, FrameIsThatOfItsPoints) {
  const mesh::ElementMesh mesh = bar(mesh::ElementOrder::kLinear);
  const PoseFeature::Options options = pose_points();
  PoseFeature feature(mesh, options);
  VectorXd value(7);
  feature.evaluate(mesh.nodes, value);
  const auto& p = options.rest_points;
  EXPECT_LT((value.head<3>() - (p[0] + p[1] + p[2]) / 3).norm(), 1e-12);
  const Eigen::Matrix3d R = math::rotation_from_wxyz(value.data() + 3);
  EXPECT_NEAR(R.determinant(), 1, 1e-12);
  EXPECT_LT((R.col(0) - (p[1] - p[0]).normalized()).norm(), 1e-12);
  EXPECT_NEAR(R.col(2).dot(p[1] - p[0]), 0, 1e-12);
  EXPECT_NEAR(R.col(2).dot(p[2] - p[0]), 0, 1e-12);
  EXPECT_GT(R.col(1).dot(p[2] - p[0]), 0);
}

TEST(PoseFeature, ErrorIsTheRotationVectorInO) {
  const PoseFeature feature(bar(mesh::ElementOrder::kLinear), pose_points());
  const Vector3d turn = Vector3d(0.2, -1, 0.5).normalized() * 2.9;
  const Eigen::Matrix3d R = math::exp_rotation({0.3, 0.4, -0.5});
  VectorXd value(7), target(7), error(6);
  value.head<3>() << 1, 2, 3;
  target.head<3>() << 1.5, 1, 3;
  math::wxyz_from_rotation(R, value.data() + 3);
  math::wxyz_from_rotation(math::exp_rotation(turn) * R, target.data() + 3);
  feature.error(value, target, error);
  EXPECT_LT((error.head<3>() - Vector3d(0.5, -1, 0)).norm(), 1e-12);
  EXPECT_LT((error.tail<3>() - turn).norm(), 1e-9);
}

TEST(PoseFeature, RefusesBadSetUpAndTargets) {
  const mesh::ElementMesh mesh = bar(mesh::ElementOrder::kLinear);
  EXPECT_THROW(PoseFeature(mesh, {{Vector3d(0.1, 0.03, 0.03), Vector3d(0.2, 0.03, 0.03),
                                   Vector3d(0.4, 0.03, 0.03)}}),
               std::invalid_argument);
  EXPECT_THROW(PoseFeature(mesh, {{Vector3d(0.1, 0.03, 0.03), Vector3d(0.1, 0.03, 0.03),
                                   Vector3d(0.4, 0.02, 0.03)}}),
               std::invalid_argument);
  const PoseFeature feature(mesh, pose_points());
  const double good[] = {0, 0, 0, 0.6, 0, 0.8, 0};
  const double long_quaternion[] = {0, 0, 0, 1, 0.1, 0, 0};
  const double infinite[] = {0, 0, std::numeric_limits<double>::infinity(), 1, 0, 0, 0};
  EXPECT_TRUE(feature.is_valid_target(good, 7));
  EXPECT_FALSE(feature.is_valid_target(good, 6));
  EXPECT_FALSE(feature.is_valid_target(long_quaternion, 7));
  EXPECT_FALSE(feature.is_valid_target(infinite, 7));
}

TEST(PoseFeature, KeepsItsOrientationWhenThePointsCollapse) {
  const mesh::ElementMesh mesh = bar(mesh::ElementOrder::kLinear);
  PoseFeature feature(mesh, pose_points());
  VectorXd before(7), after(7);
  feature.evaluate(mesh.nodes, before);
  Eigen::Matrix3Xd line = mesh.nodes;
  line.bottomRows<2>().setZero();
  feature.evaluate(line, after);
  EXPECT_EQ(after.tail<4>(), before.tail<4>());
  EXPECT_TRUE(MatrixXd(feature.jacobian()).allFinite());
  EXPECT_FALSE(feature.is_defined());
  feature.evaluate(mesh.nodes, after);
  EXPECT_TRUE(feature.is_defined());
}

}  // namespace
}  // namespace palpate::shape
