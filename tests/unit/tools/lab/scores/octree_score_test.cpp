#include "tools/lab/scores/octree_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "tools/lab/scores/cloud_distance.hpp"
#include "tools/lab/scores/cloud_view.hpp"

namespace palpate::scores {
namespace {

using Cell = std::array<int, 3>;

/// The outer layer of cells of a cube of n cells per side, its lowest cell at `first`.
std::set<Cell> shell(int n, const Cell& first) {
  std::set<Cell> cells;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        if (i % (n - 1) == 0 || j % (n - 1) == 0 || k % (n - 1) == 0)
          cells.insert({first[0] + i, first[1] + j, first[2] + k});
  return cells;
}

/// The centres of cells, m.
Eigen::Matrix3Xd middles(const std::set<Cell>& cells, double side) {
  Eigen::Matrix3Xd points(3, cells.size());
  int i = 0;
  for (const Cell& c : cells) points.col(i++) << side * c[0], side * c[1], side * c[2];
  return points;
}

TEST(OctreeAgreement, ShiftedCubeSharesTheCubesThatSetsShare) {
  const double side = 0.01;
  const std::set<Cell> truth = shell(11, {-3, 2, 0});
  for (const Cell& shift : {Cell{0, 0, 0}, Cell{1, 0, 0}, Cell{2, -1, 3}, Cell{20, 0, 0}}) {
    const std::set<Cell> estimate = shell(11, {-3 + shift[0], 2 + shift[1], 0 + shift[2]});
    int shared = 0;
    for (const Cell& c : estimate) shared += truth.count(c);
    const OctreeAgreement a = octree_agreement(middles(estimate, side), middles(truth, side), side);
    EXPECT_EQ(a.resolution, side);
    EXPECT_EQ(a.estimate_cubes, 602);  // 11^3 - 9^3
    EXPECT_EQ(a.truth_cubes, 602);
    EXPECT_EQ(a.shared_cubes, shared);
    EXPECT_NEAR(a.estimate_in_truth, shared / 602.0, 1e-12);
    EXPECT_NEAR(a.truth_in_estimate, shared / 602.0, 1e-12);
  }
}

TEST(OctreeAgreement, IsDirected) {
  // Half of the truth: all of it lies in the truth, half of which lies in it.
  const double side = 0.01;
  std::set<Cell> plate, half;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 10; ++j) {
      plate.insert({i, j, 0});
      if (i < 10) half.insert({i, j, 0});
    }
  const OctreeAgreement a = octree_agreement(middles(half, side), middles(plate, side), side);
  EXPECT_EQ(a.estimate_in_truth, 1);
  EXPECT_EQ(a.truth_in_estimate, 0.5);
  EXPECT_EQ(a.shared_cubes, 100);
  EXPECT_EQ(a.truth_cubes, 200);
}

TEST(OctreeAgreement, FallsWithDistanceByTheResolution) {
  // Planes parallel to the cubes at distance d either share them or not; averaged over all offsets
  // 1 - d / side do.
  const double side = 0.01;
  Eigen::Matrix3Xd plane(3, 9);
  for (int i = 0; i < 9; ++i) plane.col(i) << side * (i % 3), side * (i / 3), 0;
  for (const double d : {0.0, 0.002, 0.005, 0.008, 0.02}) {
    const int heights = 200;
    double forth = 0, back = 0;
    for (int h = 0; h < heights; ++h) {
      plane.row(2).setConstant(side * h / heights);
      Eigen::Matrix3Xd above = plane;
      above.row(2).array() += d;
      const OctreeAgreement a = octree_agreement(above, plane, side);
      forth += a.estimate_in_truth / heights;
      back += a.truth_in_estimate / heights;
    }
    EXPECT_NEAR(forth, std::max(0.0, 1 - d / side), 0.01) << d;
    EXPECT_NEAR(back, std::max(0.0, 1 - d / side), 0.01) << d;
  }
}

TEST(OctreeAgreement, RoundingOnRoundNumbersDoesNotDecide) {
  const SurfaceSamples samples = sample_surface(draw::make_box({0.1, 0.06, 0.04}), 0.002);
  Eigen::Matrix3Xd rounded = samples.points;
  rounded.array() += 1e-12;
  EXPECT_GT(octree_agreement(rounded, samples.points, 0.01).estimate_in_truth, 0.999);
  rounded.array() -= 2e-12;
  EXPECT_GT(octree_agreement(rounded, samples.points, 0.01).estimate_in_truth, 0.999);
}

TEST(OctreeAgreement, RefusesNonsense) {
  Eigen::Matrix3Xd point = Eigen::Vector3d(1, 2, 3);
  EXPECT_THROW(octree_agreement(point, point, 0), std::invalid_argument);
  EXPECT_THROW(octree_agreement(point, Eigen::Matrix3Xd(3, 0), 0.01), std::invalid_argument);
  EXPECT_THROW(octree_agreement(point, 1000 * point, 0.01), std::invalid_argument);
  Eigen::Matrix3Xd broken = point;
  broken(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(octree_agreement(broken, point, 0.01), std::invalid_argument);
}

TEST(VirtualCloud, SameSurfaceAgreesAndAMovedOneDoesNot) {
  camera::DepthCamera camera;
  const math::Pose X_WC = draw::look_at({0.5, -0.8, 0.4}, {0, 0, 0}, {0, 0, 1});
  const draw::TriangleMesh bar = draw::make_box({0.5, 0.06, 0.06});
  draw::TriangleMesh lower = bar;
  lower.points.row(2).array() -= 0.03;
  const Eigen::Matrix3Xd cloud = virtual_cloud(camera, X_WC, bar);
  ASSERT_GT(cloud.cols(), 5000);
  EXPECT_LT(distances_to_surface(cloud, bar).maxCoeff(), 1e-4);
  const double resolution = 0.01;
  EXPECT_EQ(octree_agreement(virtual_cloud(camera, X_WC, bar), cloud, resolution).truth_in_estimate,
            1);
  const OctreeAgreement moved =
      octree_agreement(virtual_cloud(camera, X_WC, lower), cloud, resolution);
  EXPECT_LT(moved.truth_in_estimate, 0.6);
  EXPECT_GT(moved.truth_in_estimate, 0.1);

  // An occluder hides the same part of the virtual cloud.
  camera::Body screen;
  screen.mesh = std::make_shared<const draw::TriangleMesh>(draw::make_box({0.2, 0.01, 0.3}));
  screen.X_WB.translation() << 0.1, -0.1, 0;
  screen.is_object = true;
  const Eigen::Matrix3Xd hidden = virtual_cloud(camera, X_WC, bar, {screen});
  EXPECT_LT(hidden.cols(), 0.8 * cloud.cols());
  EXPECT_LT(distances_to_surface(hidden, bar).maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace palpate::scores
