#include "core/collision/obstacle.hpp"

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "core/mesh/element_mesh.hpp"
#include "core/mesh/round_mesh.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

math::Pose tilted() {
  return math::make_pose(math::exp_rotation({0.3, -0.5, 0.9}), {0.1, -0.02, 0.3});
}

Vector3d random_point(math::Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

std::vector<Obstacle> analytic_obstacles() {
  return {{"plane", HalfSpace{}, tilted(), 0.5},
          {"box", Box{{0.03, 0.05, 0.02}}, tilted(), 0.5},
          {"sphere", Sphere{0.04}, tilted(), 0.5},
          {"rod", Cylinder{0.03}, tilted(), 0.5},
          {"cylinder", Cylinder{0.03, 0.07}, tilted(), 0.5},
          {"capsule", Capsule{0.02, 0.06}, tilted(), 0.5}};
}

/// Support function of the convex shapes of finite size: largest n . q over the points q of the
/// shape, in its frame.
double support(const Shape& shape, const Vector3d& n) {
  if (const auto* box = std::get_if<Box>(&shape)) return n.cwiseAbs().dot(box->half_size);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius * n.norm();
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return capsule->radius * n.norm() + 0.5 * capsule->length * std::abs(n.z());
  const auto& cylinder = std::get<Cylinder>(shape);
  return cylinder.radius * n.head<2>().norm() + 0.5 * cylinder.length * std::abs(n.z());
}

TEST(Obstacle, OutsideAConvexShapeTheDistanceIsThatOfItsBestSeparatingPlane) {
  math::Random random(1);
  for (const Obstacle& obstacle : analytic_obstacles()) {
    if (obstacle.name == "plane" || obstacle.name == "rod") continue;
    for (int k = 0; k < 200; ++k) {
      const Vector3d p = obstacle.X_OB.translation() + random_point(random, 0.15);
      const double d = distance(obstacle, p);
      if (d <= 0) continue;
      const Vector3d q = obstacle.X_OB.inverse() * p;
      const Vector3d n = obstacle.X_OB.linear().transpose() * normal(obstacle, p);
      // duality: max over unit n of n . q - support(n), attained at the gradient
      EXPECT_NEAR(d, n.dot(q) - support(obstacle.shape, n), 1e-12) << obstacle.name;
      for (int other = 0; other < 20; ++other) {
        const Vector3d m = random_point(random, 1).normalized();
        EXPECT_LE(m.dot(q) - support(obstacle.shape, m), d + 1e-12) << obstacle.name;
      }
    }
  }
}

TEST(Obstacle, ThePointAlongTheNormalLiesOnTheSurface) {
  math::Random random(2);
  for (const Obstacle& obstacle : analytic_obstacles()) {
    for (int k = 0; k < 200; ++k) {
      const Vector3d p = obstacle.X_OB.translation() + random_point(random, 0.1);
      const Vector3d n = normal(obstacle, p);
      EXPECT_NEAR(n.norm(), 1, 1e-12);
      EXPECT_NEAR(distance(obstacle, p - distance(obstacle, p) * n), 0, 1e-12) << obstacle.name;
    }
  }
}

TEST(Obstacle, InsideTheDistanceIsNegativeAndItsGradientPointsOut) {
  const std::vector<Obstacle> all = analytic_obstacles();
  for (const Obstacle& obstacle : all) {
    const Vector3d inside = obstacle.X_OB * Vector3d(0.004, 0.003, -0.002);
    EXPECT_LT(distance(obstacle, inside), 0) << obstacle.name;
    const Vector3d out = inside + 1e-6 * normal(obstacle, inside);
    EXPECT_NEAR(distance(obstacle, out) - distance(obstacle, inside), 1e-6, 1e-10);
  }
}

TEST(Obstacle, TheDerivativeOfTheNormalIsTheCurvature) {
  const Obstacle rod{"rod", Cylinder{0.03}, tilted(), 0.5};
  const Vector3d p = rod.X_OB * Vector3d(0.03, 0, 0.1);
  const Eigen::Matrix3d expected =
      rod.X_OB.linear() * Vector3d(0, 1 / 0.03, 0).asDiagonal() * rod.X_OB.linear().transpose();
  EXPECT_LT((normal_derivative(rod, p) - expected).norm(), 1e-6 * expected.norm());
  const Obstacle plane{"plane", HalfSpace{}, tilted(), 0.5};
  EXPECT_EQ(normal_derivative(plane, p).norm(), 0);
}

TEST(Obstacle, InvalidSizesAreNamed) {
  EXPECT_NO_THROW(analytic_obstacles()[3].check());
  Obstacle obstacle{"peg", Cylinder{-1}, tilted(), 0.5};
  EXPECT_THROW(
      try { obstacle.check(); } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("obstacle peg"), std::string::npos);
        throw;
      },
      std::invalid_argument);
  obstacle.shape = Cylinder{};
  obstacle.friction = -0.1;
  EXPECT_THROW(obstacle.check(), std::invalid_argument);
}

mesh::TriangleSurface surface_of(const mesh::TetrahedralMesh& mesh) {
  return {
      mesh.nodes,
      mesh::extract_surface(mesh::make_element_mesh(mesh, mesh::ElementOrder::kLinear)).triangles};
}

TEST(DistanceGrid, OfABoxIsThatOfTheBoxAwayFromItsEdges) {
  const Vector3d size(0.06, 0.1, 0.04);
  const double cell = 0.002;
  const auto grid =
      std::make_shared<const DistanceGrid>(surface_of(mesh::make_box(size, {3, 4, 2})), cell);
  // a grid mesh has a corner at the origin
  const Obstacle as_grid{"grid", grid, tilted(), 0.5};
  const Obstacle as_box{"box", Box{0.5 * size},
                        math::make_pose(tilted().linear(), tilted() * Vector3d(0.5 * size)), 0.5};
  math::Random random(3);
  double worst = 0, worst_at_face = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vector3d q =
        0.5 * size +
        (0.5 * size + Vector3d::Constant(2 * cell)).cwiseProduct(random_point(random, 1));
    const Vector3d p = tilted() * q;
    const double error = std::abs(distance(as_grid, p) - distance(as_box, p));
    worst = std::max(worst, error);
    const Vector3d in = (q - 0.5 * size).cwiseAbs() - 0.5 * size;
    const int near_faces = (in.array() > -3 * cell).count();
    if (near_faces > 1) continue;
    if (near_faces == 1) {
      worst_at_face = std::max(worst_at_face, error);
      EXPECT_GT(normal(as_grid, p).dot(normal(as_box, p)), 1 - 1e-6);
    }
  }
  EXPECT_LT(worst, 0.7 * cell);  // at edges and on the medial axis
  EXPECT_LT(worst_at_face, 1e-7);
}

TEST(DistanceGrid, OfASphereConvergesWithTheSquareOfTheCell) {
  const double radius = 0.05;
  const auto mesh = mesh::make_ellipsoid(Vector3d::Constant(radius), 24, mesh::RoundSides::kCurved);
  const mesh::TriangleSurface surface = surface_of(mesh.mesh);
  double chord = 0;  // m, by which the triangles lie inside the sphere
  for (int t = 0; t < surface.triangle_count(); ++t) {
    Vector3d centre = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) centre += surface.points.col(surface.triangles(i, t)) / 3;
    chord = std::max(chord, radius - centre.norm());
  }
  std::array<double, 2> worst{};
  for (int fine = 0; fine < 2; ++fine) {
    const double cell = fine ? 0.003 : 0.006;
    const DistanceGrid grid(surface, cell);
    math::Random random(4);
    for (int k = 0; k < 2000; ++k) {
      const Vector3d p =
          (radius + random.uniform(-cell, cell)) * random_point(random, 1).normalized();
      worst[fine] = std::max(worst[fine], std::abs(grid.distance(p) - (p.norm() - radius)));
    }
    EXPECT_LT(worst[fine], chord + cell * cell / radius) << cell;
  }
  EXPECT_LT(worst[1], 0.5 * worst[0]);
}

TEST(DistanceGrid, FarAwayTheDistanceIsALowerBound) {
  const DistanceGrid grid(surface_of(mesh::make_box({0.06, 0.1, 0.04}, {1, 1, 1})), 0.004);
  const double d = grid.distance({0.03, 0.05, 0.54});
  EXPECT_GT(d, 0.4);
  EXPECT_LE(d, 0.5 + 1e-9);
}

TEST(DistanceGrid, OpenOrTurnedSurfacesAreRejected) {
  mesh::TriangleSurface surface = surface_of(mesh::make_box({0.06, 0.1, 0.04}, {1, 1, 1}));
  EXPECT_NO_THROW(DistanceGrid(surface, 0.01));
  mesh::TriangleSurface open = surface;
  open.triangles.conservativeResize(3, surface.triangles.cols() - 1);
  EXPECT_THROW(DistanceGrid(open, 0.01), std::invalid_argument);
  mesh::TriangleSurface one_turned = surface;
  std::swap(one_turned.triangles(0, 0), one_turned.triangles(1, 0));
  EXPECT_THROW(DistanceGrid(one_turned, 0.01), std::invalid_argument);
  mesh::TriangleSurface inward = surface;
  inward.triangles.row(0).swap(inward.triangles.row(1));
  EXPECT_THROW(DistanceGrid(inward, 0.01), std::invalid_argument);
  EXPECT_THROW(DistanceGrid(surface, 1e-5), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::collision
