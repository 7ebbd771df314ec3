#include "sim/camera/background_camera.hpp"

#include <gtest/gtest.h>

#include "tests/unit/sim/camera/bodies.hpp"

namespace palpate::camera {
namespace {

std::vector<Body> ball(double y) {
  return {body(draw::make_sphere(0.1), at(1, y, 0), kAmber, true)};
}

ShapeCameraOptions options() {
  ShapeCameraOptions o;
  o.X_WC = camera_along_x();
  o.segmentation = Segmentation::kTruth;
  return o;
}

TEST(BackgroundCamera, GivesWhatTheCameraItselfGives) {
  BackgroundCamera camera(options(), 100);
  ShapeCamera reference(options());
  EXPECT_FALSE(camera.collect(true));  // nothing was requested
  for (int i = 0; i < 5; ++i) {
    camera.submit(ball(0.02 * i), math::Random(i));
    EXPECT_TRUE(camera.busy());
    EXPECT_THROW(camera.submit(ball(0), math::Random(1)), std::logic_error);
    const auto reading = camera.collect(true);
    ASSERT_TRUE(reading);
    EXPECT_FALSE(camera.busy());
    EXPECT_FALSE(camera.collect(false));
    const ShapeReading expected = reference.look(ball(0.02 * i), math::Random(i), 100);
    EXPECT_EQ(reading->points_W, expected.points_W);
    EXPECT_EQ(reading->deviation, expected.deviation);
  }
}

TEST(BackgroundCamera, HandsErrorsOver) {
  ShapeCameraOptions wrong = options();
  wrong.noise.base = -1;
  EXPECT_THROW(BackgroundCamera(wrong, 100), std::invalid_argument);

  BackgroundCamera camera(options(), 100);
  draw::TriangleMesh broken = draw::make_sphere(0.1);
  broken.triangles(0, 0) = 100000;
  camera.submit({body(broken, at(1, 0, 0))}, math::Random(1));
  EXPECT_THROW(camera.collect(true), std::invalid_argument);
  camera.submit(ball(0), math::Random(1));  // and continues
  EXPECT_TRUE(camera.collect(true));
}

TEST(BackgroundCamera, EndsWithAPictureInWork) {
  BackgroundCamera camera(options(), 100);
  camera.submit(ball(0), math::Random(1));
}

}  // namespace
}  // namespace palpate::camera
