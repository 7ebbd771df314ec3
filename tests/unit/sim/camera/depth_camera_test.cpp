#include "sim/camera/depth_camera.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/unit/sim/camera/bodies.hpp"

namespace palpate::camera {
namespace {

using Eigen::Vector3d;

/// Intersection of a ray from `eye` with the nearest triangle, in lengths of `ray` (Moeller and
/// Trumbore 1997); infinity if there is none. `rim` is the smallest distance to the border of any
/// hit triangle, relative to its height.
struct Hit {
  double length = std::numeric_limits<double>::infinity();
  double rim = 0;
};

Hit cast(const std::vector<Body>& bodies, const Vector3d& eye, const Vector3d& ray) {
  Hit nearest;
  for (const Body& body : bodies) {
    const Vector3d from = body.X_WB.inverse() * eye;
    const Vector3d along = body.X_WB.linear().transpose() * ray;
    for (const auto& t : body.mesh->triangles.colwise()) {
      const Vector3d a = body.mesh->points.col(t[0]);
      const Vector3d ab = body.mesh->points.col(t[1]) - a, ac = body.mesh->points.col(t[2]) - a;
      const Vector3d h = along.cross(ac);
      const double determinant = ab.dot(h);
      if (std::abs(determinant) < 1e-15) continue;
      const double u = (from - a).dot(h) / determinant;
      const Vector3d q = (from - a).cross(ab);
      const double v = along.dot(q) / determinant;
      if (u < 0 || v < 0 || u + v > 1) continue;
      const double length = ac.dot(q) / determinant;
      if (length > 0 && length < nearest.length) nearest = {length, std::min({u, v, 1 - u - v})};
    }
  }
  return nearest;
}

struct Comparison {
  int both = 0;      // pixels with a hit in both image and ray
  int one = 0;       // with a hit in only one of them
  double worst = 0;  // m, over the pixels that are not edges
  double mean = 0;   // m
  int edges = 0;     // pixels at a border that show another surface than the ray
};

/// Casts a ray through every third pixel.
Comparison compare(const DepthFrame& frame, const std::vector<Body>& bodies) {
  Comparison c;
  const draw::Intrinsics& k = frame.view.intrinsics;
  for (int row = 0; row < frame.depth.height; row += 3) {
    for (int column = 0; column < frame.depth.width; column += 3) {
      const Vector3d ray =
          frame.view.X_WC.linear() * Vector3d((column - k.cx) / k.fx, (row - k.cy) / k.fy, 1);
      const Hit hit = cast(bodies, frame.view.X_WC.translation(), ray);
      const double seen = frame.depth.at(column, row);
      if (std::isinf(hit.length) && seen == 0) continue;
      if (std::isinf(hit.length) || seen == 0) {
        ++c.one;
        continue;
      }
      ++c.both;
      const double error = std::abs(seen - hit.length);  // the ray advances 1 along the axis
      if (error > 1e-3 && hit.rim < 0.02) {
        ++c.edges;
        continue;
      }
      c.worst = std::max(c.worst, error);
      c.mean += error;
    }
  }
  c.mean /= std::max(1, c.both - c.edges);
  return c;
}

TEST(DepthCamera, AgreesWithRayCastingAtEightyCentimetres) {
  const std::vector<Body> bodies{
      body(draw::make_box({0.06, 0.5, 0.06}), at(0.8, 0.02, 0.01, {0.3, 0.2, 0.5}), kAmber, true),
      body(draw::make_sphere(0.08), at(0.75, -0.2, 0.12)),
      body(draw::make_cylinder(0.05, 0.3), at(0.85, 0.18, -0.1, {0.9, -0.4, 0.2}))};
  DepthCamera camera;
  const DepthFrame frame = camera.take(camera_along_x(), bodies);
  EXPECT_EQ(frame.depth.width, 640);
  EXPECT_EQ(frame.depth.height, 480);
  const Comparison c = compare(frame, bodies);
  std::printf(
      "depth against ray casting at 0.8 m: mean %.2g mm, worst %.2g mm over %d rays; %d at "
      "borders, %d seen by one only\n",
      1e3 * c.mean, 1e3 * c.worst, c.both, c.edges, c.one);
  EXPECT_GT(c.both, 2000);
  EXPECT_LT(c.worst, 1e-3);
  EXPECT_LT(c.edges + c.one, c.both / 200);
}

TEST(DepthCamera, PoseOfTheCameraIsTheViewsPose) {
  // The same scene rigidly moved looks the same.
  const std::vector<Body> bodies{
      body(draw::make_box({0.1, 0.3, 0.2}), at(0.8, 0.05, -0.03, {0, 0, 0.4}))};
  const math::Pose X = at(0.3, -0.7, 1.1, {0.5, -1.2, 0.8});
  std::vector<Body> moved = bodies;
  moved[0].X_WB = X * bodies[0].X_WB;
  DepthCamera camera;
  const DepthFrame here = camera.take(camera_along_x(), bodies);
  const DepthFrame there = camera.take(X * camera_along_x(), moved);
  int differing = 0, seen = 0;
  for (std::size_t i = 0; i < here.depth.metres.size(); ++i) {
    seen += here.depth.metres[i] > 0;
    differing += std::abs(here.depth.metres[i] - there.depth.metres[i]) > 1e-5;
  }
  EXPECT_GT(seen, 5000);
  EXPECT_LT(differing, 20);  // rounding at the outline
}

int count(const Mask& mask) { return static_cast<int>(std::count(mask.begin(), mask.end(), 1)); }

TEST(DepthCamera, ABoxInFrontHidesTheObject) {
  const Body object = body(draw::make_box({0.06, 0.4, 0.06}), at(0.8, 0, 0), kAmber, true);
  const Body behind = body(draw::make_box({0.1, 1, 1}), at(1.2, 0, 0));
  // Of the width of 0.4 m, 0.1 m is occluded by a screen at half the distance.
  const double front = 0.77, screen = 0.4;
  const Body half = body(draw::make_box({0.001, 0.1 * screen / front, 1}), at(screen, 0, 0));
  const Body all = body(draw::make_box({0.001, 1, 1}), at(screen, 0, 0));
  DepthCamera camera;
  const auto visible = [&](const std::vector<Body>& bodies) {
    const DepthFrame frame = camera.take(camera_along_x(), bodies);
    return count(camera.object_mask(frame, bodies));
  };
  const int whole = visible({behind, object});
  const double focal = KinectModel::kFocalLength;
  EXPECT_NEAR(whole, focal * 0.4 / front * focal * 0.06 / front, 0.02 * whole);
  EXPECT_NEAR(visible({behind, object, half}), 0.75 * whole, 0.01 * whole);
  EXPECT_EQ(visible({behind, object, all}), 0);
  EXPECT_EQ(visible({object, behind}), whole);  // the order does not matter
}

TEST(DepthCamera, MaskShowsTheObjectAndNothingElse) {
  const std::vector<Body> bodies{
      body(draw::make_sphere(0.1), at(0.8, 0.1, 0), kAmber, true),
      body(draw::make_sphere(0.1), at(0.8, -0.1, 0.05), kAmber)};  // alike, but not the object
  DepthCamera camera;
  const DepthFrame frame = camera.take(camera_along_x(), bodies);
  const Mask mask = camera.object_mask(frame, bodies);
  int wrong = 0, object = 0;
  for (int row = 0; row < 480; ++row) {
    for (int column = 0; column < 640; ++column) {
      const double z = frame.depth.at(column, row);
      if (z == 0) {
        wrong += mask[row * 640 + column];
        continue;
      }
      const draw::Intrinsics& k = frame.view.intrinsics;
      const Vector3d p =
          frame.view.X_WC * Vector3d(z * (column - k.cx) / k.fx, z * (row - k.cy) / k.fy, z);
      const bool is_object = std::abs((p - Vector3d(0.8, 0.1, 0)).norm() - 0.1) < 1e-3;
      object += is_object;
      wrong += is_object != (mask[row * 640 + column] == 1);
    }
  }
  EXPECT_GT(object, 5000);
  EXPECT_LT(wrong, object / 200);  // both spheres are near each other's surface at one point
}

}  // namespace
}  // namespace palpate::camera
