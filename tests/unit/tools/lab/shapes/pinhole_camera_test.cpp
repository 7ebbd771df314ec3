#include "tools/lab/shapes/pinhole_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::shapes {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Looks along -z from z = 0.5.
PinholeCamera frontal() {
  PinholeCamera camera;
  camera.focal = {500, 500};
  camera.centre = {100, 80};
  camera.width = 200;
  camera.height = 160;
  camera.rotation = Vector3d(1, -1, -1).asDiagonal();
  camera.translation = {0, 0, 0.5};
  return camera;
}

TEST(PinholeCamera, ProjectsAndMeetsPlanes) {
  const PinholeCamera camera = frontal();
  EXPECT_TRUE(camera.project({0.01, 0.02, 0}).isApprox(Vector2d(110, 60)));
  const Vector3d p(0.02, -0.03, 0.1);
  const Vector3d q = camera.onto_plane(p, -0.2);
  EXPECT_DOUBLE_EQ(q.z(), -0.2);
  EXPECT_TRUE(camera.project(q).isApprox(camera.project(p)));
  EXPECT_NEAR(camera.obliquity(), 0, 1e-9);
}

TEST(PinholeCamera, DistanceToALineIsThatOfItsNearestSegment) {
  const Eigen::Matrix2Xd line = (Eigen::Matrix2Xd(2, 3) << 0, 10, 10, 0, 0, 10).finished();
  EXPECT_DOUBLE_EQ(distance_to_line({5, 3}, line), 3);
  EXPECT_DOUBLE_EQ(distance_to_line({13, 5}, line), 3);
  EXPECT_DOUBLE_EQ(distance_to_line({-3, -4}, line), 5);
  EXPECT_TRUE(std::isinf(distance_to_line({0, 0}, line.leftCols(1))));
}

TEST(PinholeCamera, OutlineOfASquareIsItsBorder) {
  Eigen::Matrix3Xd p(3, 4);  // 20 x 20 pixels about (100, 80)
  p << -0.01, 0.01, 0.01, -0.01, -0.01, -0.01, 0.01, 0.01, 0, 0, 0, 0;
  const Eigen::Matrix3Xi triangles = (Eigen::Matrix3Xi(3, 2) << 0, 0, 1, 2, 2, 3).finished();
  const SurfaceOutline outline = surface_outline(frontal(), p, triangles, {false, false});
  EXPECT_EQ(outline.whole.cols(), 80);
  for (int i = 0; i < outline.whole.cols(); ++i)
    EXPECT_NEAR((outline.whole.col(i) - Vector2d(100, 80)).cwiseAbs().maxCoeff(), 10, 1e-9);
}

TEST(PinholeCamera, OutlineWithoutMarkedTrianglesKeepsWhatCoversThem) {
  Eigen::Matrix3Xd p(3, 6);  // the marked triangle lies behind the other and sticks out to the left
  p << -0.01, 0.01, 0, -0.04, 0.01, 0, -0.01, -0.01, 0.02, 0, 0, 0.005, 0.1, 0.1, 0.1, 0, 0, 0;
  const Eigen::Matrix3Xi triangles = (Eigen::Matrix3Xi(3, 2) << 0, 3, 1, 4, 2, 5).finished();
  const SurfaceOutline outline = surface_outline(frontal(), p, triangles, {false, true});
  const SurfaceOutline alone = surface_outline(frontal(), p, triangles.leftCols<1>(), {false});
  EXPECT_LT(outline.whole.row(0).minCoeff(), 70);
  EXPECT_TRUE(outline.without.isApprox(alone.whole));
}

}  // namespace
}  // namespace palpate::shapes
