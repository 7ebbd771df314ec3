#include "sim/camera/point_cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/math/random.hpp"
#include "sim/camera/shape_camera.hpp"
#include "tests/unit/sim/camera/bodies.hpp"

namespace palpate::camera {
namespace {

TEST(BackProject, UndoesTheProjection) {
  const draw::Intrinsics k{585, 580, 310, 250};
  const Eigen::Vector3d p(0.12, -0.07, 0.9);
  const double column = k.fx * p.x() / p.z() + k.cx, row = k.fy * p.y() / p.z() + k.cy;
  EXPECT_LT((back_project(k, column, row, p.z()) - p).norm(), 1e-12);
}

TEST(BackProject, PointsOfASphereLieOnIt) {
  const Eigen::Vector3d centre(0.9, 0.1, -0.05);
  const std::vector<Body> bodies{
      body(draw::make_sphere(0.15), at(centre.x(), centre.y(), centre.z()), kAmber, true)};
  DepthCamera camera;
  const math::Pose X_WC = draw::look_at({0.1, -0.4, 0.3}, centre, {0, 0, 1});
  const DepthFrame frame = camera.take(X_WC, bodies);
  const Eigen::Matrix3Xd points_C = back_project(frame.depth, camera.intrinsics());
  const Eigen::Matrix3Xd points_W = (X_WC.linear() * points_C).colwise() + X_WC.translation();
  ASSERT_GT(points_W.cols(), 10000);
  const Eigen::VectorXd radius = (points_W.colwise() - centre).colwise().norm();
  EXPECT_LT(radius.maxCoeff(), 0.15 + 1e-5);
  EXPECT_GT(radius.minCoeff(), 0.15 * 0.99);  // facets
  // Only the side facing the camera.
  const Eigen::Vector3d towards = (X_WC.translation() - centre).normalized();
  EXPECT_GT((towards.transpose() * (points_W.colwise() - centre)).minCoeff(), 0);

  Mask left(frame.depth.metres.size());
  for (int row = 0; row < 480; ++row)
    for (int column = 0; column < 320; ++column) left[row * 640 + column] = 1;
  const Eigen::Matrix3Xd half = back_project(frame.depth, camera.intrinsics(), left);
  EXPECT_LT(half.row(0).maxCoeff(), 0);
  EXPECT_NEAR(half.cols(), 0.5 * points_C.cols(), 0.01 * points_C.cols());
  EXPECT_THROW(back_project(frame.depth, camera.intrinsics(), Mask(3)), std::invalid_argument);
}

TEST(ThinByVoxels, KeepsOneMeasuredPointACube) {
  math::Random random(3);
  Eigen::Matrix3Xd cloud(3, 4000);
  for (Eigen::Index i = 0; i < cloud.cols(); ++i)
    for (int a = 0; a < 3; ++a) cloud(a, i) = random.uniform(-0.1, 0.1);
  const double voxel = 0.05;
  const Eigen::Matrix3Xd thin = thin_by_voxels(cloud, voxel, 1000);
  EXPECT_EQ(thin.cols(), 64);  // 4 x 4 x 4 voxels, very likely with a point each
  std::set<std::array<int, 3>> cubes;
  for (Eigen::Index i = 0; i < thin.cols(); ++i) {
    std::array<int, 3> cube;
    for (int a = 0; a < 3; ++a) cube[a] = static_cast<int>(std::floor(thin(a, i) / voxel));
    EXPECT_TRUE(cubes.insert(cube).second);
    const double nearest = (cloud.colwise() - thin.col(i)).colwise().norm().minCoeff();
    EXPECT_EQ(nearest, 0);
    // Near the centre of its voxel.
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(thin(a, i), voxel * (cube[a] + 0.5), 0.4 * voxel);
  }
}

TEST(ThinByVoxels, NeverLeavesMoreThanAskedFor) {
  math::Random random(5);
  Eigen::Matrix3Xd sheet(3, 20000);
  for (Eigen::Index i = 0; i < sheet.cols(); ++i)
    sheet.col(i) << random.uniform(0, 1), random.uniform(0, 0.3), 0.1;
  for (const int most : {1, 10, 256}) {
    const Eigen::Index left = thin_by_voxels(sheet, 0.005, most).cols();
    EXPECT_LE(left, most);
    EXPECT_GE(left, 0.5 * most);
  }
  EXPECT_EQ(thin_by_voxels(Eigen::Matrix3Xd(3, 0), 0.01, 10).cols(), 0);
  EXPECT_THROW(thin_by_voxels(sheet, 0, 10), std::invalid_argument);
}

TEST(Segment, BoxAndColourFindTheObjectAmongOthers) {
  const draw::Colour orange{0.95F, 0.45F, 0.10F, 1}, skin{0.25F, 0.55F, 0.35F, 1};
  const std::vector<Body> bodies{
      body(draw::make_box({0.06, 0.5, 0.06}), at(0.8, 0, 0, {0.2, 0.3, 0.4}), kAmber, true),
      body(draw::make_cylinder(0.05, 0.2), at(0.7, 0.2, 0), orange),
      body(draw::make_sphere(0.04), at(0.72, 0, 0.02), skin),
      body(draw::make_box({0.2, 2, 0.02}), at(0.9, 0, -0.15)),
      body(draw::make_sphere(0.05), at(0.8, -0.1, 0.2),
           kAmber)};  // same colour, but outside the box
  DepthCamera camera;
  const DepthFrame frame = camera.take(camera_along_x(), bodies);
  const Mask truth = camera.object_mask(frame, bodies);
  ObjectFilter filter;
  filter.X_WB = at(0.8, 0, 0);
  filter.lower << -0.3, -0.3, -0.12;
  filter.upper << 0.3, 0.3, 0.12;
  filter.colour = kAmber;
  const auto score = [&](const Mask& found) {
    int right = 0, missed = 0, wrong = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      right += found[i] && truth[i];
      missed += !found[i] && truth[i];
      wrong += found[i] && !truth[i];
    }
    return std::array<double, 3>{double(right), missed / double(right + missed),
                                 wrong / double(right + missed)};
  };
  const auto [right, missed, wrong] = score(segment(frame, filter));
  EXPECT_GT(right, 5000);
  EXPECT_LT(missed, 0.02);
  EXPECT_LT(wrong, 0.02);
  filter.upper.z() = 1;  // the box no longer excludes the second amber object
  EXPECT_GT(score(segment(frame, filter))[2], 0.1);
  filter.upper.z() = 0.12;
  filter.tolerance = 2;  // nor colour the others
  EXPECT_GT(score(segment(frame, filter))[2], 0.2);
  filter.tolerance = 1e-4;
  EXPECT_LT(score(segment(frame, filter))[0], 0.5 * right);
}

TEST(WithoutMargin, ShrinksARectangleOnEverySide) {
  const int width = 20, height = 12;
  Mask mask(width * height);
  for (int row = 0; row < 9; ++row)  // touches the upper border
    for (int column = 4; column < 16; ++column) mask[row * width + column] = 1;
  mask[5 * width + 9] = 0;  // a hole
  const Mask shrunk = without_margin(mask, width, 2);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const bool inside = row >= 2 && row < 7 && column >= 6 && column < 14;
      const bool near_hole = std::abs(row - 5) <= 2 && std::abs(column - 9) <= 2;
      EXPECT_EQ(shrunk[row * width + column], inside && !near_hole) << column << " " << row;
    }
  }
  EXPECT_EQ(without_margin(mask, width, 0), mask);
}

}  // namespace
}  // namespace palpate::camera
