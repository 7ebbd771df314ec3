// Closest points of a bent object to obstacles, compared with many points of its surface.
#include "core/control/obstacle_gaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/control/surface_distance.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::control {
namespace {

using Eigen::Vector3d;

/// A bar of half a metre bent to a circle about an axis above it.
class BentBar : public ::testing::TestWithParam<mesh::ElementOrder> {
 protected:
  BentBar() : mesh_(palpate::support::held_bar({8, 1, 1}, GetParam()).mesh) {
    surface_ = mesh::extract_surface(mesh_);
    x_ = mesh_.nodes;
    constexpr double kRadius = 0.2;
    for (int i = 0; i < x_.cols(); ++i) {
      const double angle = (mesh_.nodes(0, i) - 0.25) / kRadius, r = kRadius - mesh_.nodes(2, i);
      x_.col(i) << 0.25 + r * std::sin(angle), mesh_.nodes(1, i), kRadius - r * std::cos(angle);
    }
  }
  mesh::ElementMesh mesh_;
  mesh::Surface surface_;
  Eigen::Matrix3Xd x_;
};

/// Halfway between two nodes, along and across, outside and inside the bar's surface; B is turned
/// about an oblique axis where the shape has edges.
std::vector<collision::Obstacle> obstacles() {
  const Eigen::Matrix3d level = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d across = math::exp_rotation({M_PI / 2, 0, 0});
  const Eigen::Matrix3d oblique = math::exp_rotation({0.4, 0.3, 0.2});
  return {
      {"ball", collision::Sphere{0.03}, math::make_pose(level, {0.235, 0.021, 0.13})},
      {"second ball", collision::Sphere{0.02}, math::make_pose(level, {0.31, 0.03, 0.12})},
      {"floor", collision::HalfSpace{}, math::make_pose(level, {0, 0, -0.02})},
      {"rod", collision::Cylinder{0.03}, math::make_pose(across, {0.29, 0, 0.115})},
      {"pin", collision::Capsule{0.01, 0.04}, math::make_pose(oblique, {0.22, 0.024, 0.11})},
      {"crate", collision::Box{{0.02, 0.015, 0.01}}, math::make_pose(oblique, {0.28, 0.036, 0.11})},
      {"in the bar", collision::Sphere{0.03}, math::make_pose(level, {0.235, 0.021, 0.07})}};
}

TEST_P(BentBar, ComesNearestBetweenNodes) {
  const std::vector<collision::Obstacle> all = obstacles();
  constexpr double kFallbackDeviation = 7e-4;
  ObstacleGaps gaps(mesh_, all, kFallbackDeviation);
  gaps.look(x_, nullptr);
  ASSERT_EQ(gaps.points().size(), all.size() * ObstacleGaps::kPoints);
  for (std::size_t o = 0; o < all.size(); ++o) {
    SCOPED_TRACE(all[o].name);
    const ObstacleGaps::Point* const points = gaps.points().data() + o * ObstacleGaps::kPoints;
    const double expected = support::least_on_surface(
        surface_, x_, [&](const Vector3d& q) { return collision::distance(all[o], q); }, 96);
    EXPECT_NEAR(points[0].gap, expected, 5e-5);
    EXPECT_LE(points[0].gap, expected + 1e-6) << "many points are never nearer than the nearest";
    std::vector<double> of_nodes;
    for (const int node : surface_.nodes)
      of_nodes.push_back(collision::distance(all[o], x_.col(node)));
    std::sort(of_nodes.begin(), of_nodes.end());
    for (int i = 1; i < ObstacleGaps::kPoints; ++i) {
      EXPECT_EQ(points[i].gap, of_nodes[static_cast<std::size_t>(i - 1)]);
      EXPECT_EQ(points[i].on.count, 1);
      EXPECT_EQ(points[i].on.position, x_.col(points[i].on.nodes[0]));
      const Vector3d foot = points[i].on.position - points[i].gap * points[i].away_O;
      EXPECT_NEAR(collision::distance(all[o], foot), 0, 1e-12);
    }
    EXPECT_EQ(points[0].deviation, kFallbackDeviation);
  }
  EXPECT_GT(gaps.points()[1].gap, gaps.points()[0].gap + 1e-4) << "nodes alone would not see it";
}

TEST_P(BentBar, FollowsAnObstacleThatMoves) {
  ObstacleGaps gaps(mesh_, {obstacles()[2]}, 0);
  gaps.look(x_, nullptr);
  const double before = gaps.points()[0].gap;
  collision::Placement placement;
  placement.X_OB = math::make_pose(Eigen::Matrix3d::Identity(), {0, 0, -0.027});
  const palpate::loop::NoAllocationScope scope;
  gaps.place(0, placement);
  gaps.look(x_, nullptr);
  EXPECT_NEAR(gaps.points()[0].gap, before + 0.007, 1e-12);
  placement.is_known = false;
  gaps.place(0, placement);
  gaps.look(x_, nullptr);
  EXPECT_EQ(scope.count(), 0);
  for (const ObstacleGaps::Point& point : gaps.points()) EXPECT_TRUE(std::isinf(point.gap));
}

TEST_P(BentBar, GivesTheLargestDeviationOfItsNodes) {
  ObstacleGaps gaps(mesh_, {obstacles()[0]}, 0.1);
  std::vector<float> deviation(static_cast<std::size_t>(mesh_.node_count()), 1e-4F);
  gaps.look(x_, nullptr);
  const contact::SurfaceMatch& on = gaps.points()[0].on;
  deviation[static_cast<std::size_t>(on.nodes[1])] = 2e-3F;
  const palpate::loop::NoAllocationScope scope;
  gaps.look(x_, &deviation);
  EXPECT_EQ(scope.count(), 0);
  EXPECT_FLOAT_EQ(static_cast<float>(gaps.points()[0].deviation), 2e-3F);
}

INSTANTIATE_TEST_SUITE_P(Orders, BentBar,
                         ::testing::Values(mesh::ElementOrder::kLinear,
                                           mesh::ElementOrder::kQuadratic));

}  // namespace
}  // namespace palpate::control
