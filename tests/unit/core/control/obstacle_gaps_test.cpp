// Closest points of a bent object to obstacles, compared with many points of its surface.
#include "core/control/obstacle_gaps.hpp"

#include <gtest/gtest.h>

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

TEST_P(BentBar, ComesNearestBetweenNodes) {
  // Halfway between two nodes, along and across.
  const std::vector<Obstacle> balls{{{0.235, 0.021, 0.13}, 0.03}, {{0.31, 0.03, 0.12}, 0.02}};
  constexpr double kFallbackDeviation = 7e-4;
  ObstacleGaps gaps(surface_, balls, kFallbackDeviation);
  gaps.look(x_, nullptr);
  ASSERT_EQ(gaps.points().size(), 2u * ObstacleGaps::kPoints);
  for (std::size_t o = 0; o < balls.size(); ++o) {
    const ObstacleGaps::Point* const points = gaps.points().data() + o * ObstacleGaps::kPoints;
    const double expected =
        support::distance_to_surface(surface_, x_, balls[o].center_O) - balls[o].radius;
    EXPECT_NEAR(points[0].gap, expected, 5e-5);
    EXPECT_LE(points[0].gap, expected + 1e-6) << "many points are never nearer than the nearest";
    for (int i = 1; i < ObstacleGaps::kPoints; ++i) {
      EXPECT_GE(points[i].gap, points[i - 1].gap);
      EXPECT_EQ(points[i].on.count, 1);
      EXPECT_LT((balls[o].center_O + (points[i].gap + balls[o].radius) * points[i].away_O -
                 x_.col(points[i].on.nodes[0]))
                    .norm(),
                1e-12);
    }
    EXPECT_EQ(points[0].deviation, kFallbackDeviation);
  }
  EXPECT_GT(gaps.points()[1].gap, gaps.points()[0].gap + 1e-4) << "nodes alone would not see it";
}

TEST_P(BentBar, GivesTheLargestDeviationOfItsNodes) {
  ObstacleGaps gaps(surface_, {{{0.235, 0.021, 0.13}, 0.03}}, 0.1);
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
