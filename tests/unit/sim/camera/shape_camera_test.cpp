#include "sim/camera/shape_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/unit/sim/camera/bodies.hpp"

namespace palpate::camera {
namespace {

const Eigen::Vector3d kSize(0.06, 0.5, 0.08);

std::vector<Body> bar_and_hand() {
  return {body(draw::make_box(kSize), at(0.8, 0, 0), kAmber, true),
          body(draw::make_box({0.1, 0.1, 0.2}), at(0.7, 0.15, 0))};
}

ShapeCameraOptions shape_camera_options() {
  ShapeCameraOptions o;
  o.X_WC = draw::look_at({0, 0.1, 0.3}, {0.8, 0, 0}, {0, 0, 1});
  o.filter.X_WB = at(0.8, 0, 0);
  o.filter.lower.setConstant(-0.4);
  o.filter.upper.setConstant(0.4);
  o.filter.colour = kAmber;
  return o;
}

/// Signed distance of a point from the surface of the bar.
double off_the_bar(const Eigen::Vector3d& p) {
  const Eigen::Vector3d out = (p - Eigen::Vector3d(0.8, 0, 0)).cwiseAbs() - 0.5 * kSize;
  return out.maxCoeff() > 0 ? out.cwiseMax(0).norm() : out.maxCoeff();
}

TEST(ShapeCamera, PointsLieOnTheObjectWithinTheirDeviation) {
  ShapeCamera camera(shape_camera_options());
  double squares = 0, deviation = 0;
  int count = 0, far = 0;
  for (int i = 0; i < 10; ++i) {
    const ShapeReading reading = camera.look(bar_and_hand(), math::Random(i), 256);
    ASSERT_GT(reading.points_W.cols(), 100);
    ASSERT_LE(reading.points_W.cols(), 256);
    deviation = reading.deviation;
    for (const auto& p : reading.points_W.colwise()) {
      const double distance = off_the_bar(p);
      squares += distance * distance;
      far += std::abs(distance) > 5 * deviation;
      ++count;
    }
  }
  const double rms = std::sqrt(squares / count);
  std::printf(
      "distance of points from the surface: rms %.2f mm, stated %.2f mm, %d of %d beyond 5 of it\n",
      1e3 * rms, 1e3 * deviation, far, count);
  // Surfaces are viewed at 20 to 70 degrees here, so the distance to them is less than along the
  // ray.
  EXPECT_LT(rms, 1.1 * deviation);
  EXPECT_GT(rms, 0.4 * deviation);
  EXPECT_LT(far, 0.01 * count);
}

TEST(ShapeCamera, CloudsHoldAllThatIsSeenWithItsColour) {
  ShapeCameraOptions o = shape_camera_options();
  o.cloud_stride = 4;
  o.noise.scale = 0;
  o.noise.disparity_step = 0;
  ShapeCamera both(o);
  const ShapeReading reading = both.look(bar_and_hand(), math::Random(1), 4000);
  o.has_shape = false;
  const ColouredCloud cloud = ShapeCamera(o).look(bar_and_hand(), math::Random(1), 4000).cloud_C;
  EXPECT_EQ(cloud.points, reading.cloud_C.points);
  EXPECT_EQ(cloud.rgb, reading.cloud_C.rgb);
  ASSERT_EQ(cloud.rgb.size(), 3u * cloud.points.cols());
  EXPECT_GT(cloud.points.cols(), reading.points_W.cols());

  // Each point lies on the ray of a fourth pixel, at the depth of the image without noise.
  DepthCamera camera;
  const DepthFrame frame = camera.take(o.X_WC, bar_and_hand());
  const draw::Intrinsics k = camera.intrinsics();
  int amber = 0, others = 0;
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    const Eigen::Vector3d p = cloud.points.col(i).cast<double>();
    const double column = k.fx * p.x() / p.z() + k.cx, row = k.fy * p.y() / p.z() + k.cy;
    ASSERT_NEAR(std::remainder(column, 4), 0, 1e-3);
    ASSERT_NEAR(std::remainder(row, 4), 0, 1e-3);
    const int c = static_cast<int>(std::lround(column)), r = static_cast<int>(std::lround(row));
    EXPECT_FLOAT_EQ(static_cast<float>(p.z()), frame.depth.at(c, r));
    const std::uint8_t* rgb = &cloud.rgb[3 * i];
    EXPECT_TRUE(std::equal(rgb, rgb + 3, frame.colour.pixel(c, r)));
    (rgb[0] > 1.5 * rgb[2] ? amber : others) += 1;
  }
  EXPECT_GT(amber, 100);
  EXPECT_GT(others, 10);
  EXPECT_THROW(coloured_cloud(frame, 0), std::invalid_argument);

  // A camera that is believed to be 5 cm to its right sees everything 5 cm to the right.
  o.calibration_error.translation() = Eigen::Vector3d(0.05, 0, 0);
  const ColouredCloud moved = ShapeCamera(o).look(bar_and_hand(), math::Random(1), 4000).cloud_C;
  EXPECT_LT((moved.points.colwise() - Eigen::Vector3f(0.05F, 0, 0) - cloud.points).norm(), 1e-4F);
}

TEST(ShapeCamera, TruthAndColourSegmentationAgree) {
  ShapeCameraOptions o = shape_camera_options();
  const ShapeReading by_colour = ShapeCamera(o).look(bar_and_hand(), math::Random(1), 4000);
  o.segmentation = Segmentation::kTruth;
  const ShapeReading by_truth = ShapeCamera(o).look(bar_and_hand(), math::Random(1), 4000);
  EXPECT_NEAR(by_colour.points_W.cols(), by_truth.points_W.cols(), 0.1 * by_truth.points_W.cols());
  EXPECT_LT((by_colour.points_W.rowwise().mean() - by_truth.points_W.rowwise().mean()).norm(),
            5e-3);
}

TEST(ShapeCamera, TheHandHidesAPartOfTheObject) {
  ShapeCamera camera(shape_camera_options());
  const auto in_the_shade = [&](const std::vector<Body>& bodies) {
    const ShapeReading reading = camera.look(bodies, math::Random(1), 4000);
    int found = 0;
    for (const auto& p : reading.points_W.colwise()) found += p.y() > 0.12 && p.y() < 0.16;
    return found;
  };
  EXPECT_GT(in_the_shade({bar_and_hand()[0]}), 30);
  EXPECT_EQ(in_the_shade(bar_and_hand()), 0);
}

TEST(ShapeCamera, SeedDecidesAloneAndNothingSeenIsNoPoint) {
  ShapeCamera camera(shape_camera_options());
  const auto points = [&](std::uint64_t seed) {
    return camera.look(bar_and_hand(), math::Random(seed), 256).points_W;
  };
  const Eigen::Matrix3Xd first = points(3);
  EXPECT_EQ(first, points(3));
  const Eigen::Matrix3Xd other = points(4);
  EXPECT_TRUE(first.cols() != other.cols() || first != other);
  EXPECT_EQ(camera.look({}, math::Random(1), 256).points_W.cols(), 0);
}

}  // namespace
}  // namespace palpate::camera
