#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/mesh/report.hpp"
#include "core/mesh/round_mesh.hpp"
#include "core/mesh/surface.hpp"
#include "core/mesh/tetrahedron_quality.hpp"

namespace palpate::mesh {
namespace {

TetrahedralMesh one(const Eigen::Matrix<double, 3, 4>& corners) {
  TetrahedralMesh mesh{corners, Eigen::Matrix4Xi(4, 1)};
  mesh.tetrahedra.col(0) << 0, 1, 2, 3;
  return mesh;
}

TEST(TetrahedronQuality, OfARegularOneAnywhereAndOfAnySize) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  Eigen::Matrix<double, 3, 4> corners;
  corners << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  corners.col(2).swap(corners.col(3));
  for (int i = 0; i < 20; ++i) {
    const double size = std::pow(10, 3 * number(random));
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(number(random), number(random), number(random), number(random))
            .normalized();
    const TetrahedronQuality q = measure(one(size * (turn.toRotationMatrix() * corners)), 0);
    EXPECT_NEAR(q.radius_ratio, 1, 1e-12);
    EXPECT_NEAR(q.scaled_jacobian, 1, 1e-12);
    EXPECT_NEAR(q.stiffness, 1, 1e-9);
    EXPECT_NEAR(q.smallest_angle, std::acos(1.0 / 3), 1e-12);
    EXPECT_NEAR(q.largest_angle, std::acos(1.0 / 3), 1e-12);
    EXPECT_NEAR(std::abs(q.volume), 8.0 / 3 * std::pow(size, 3), 1e-9 * std::pow(size, 3));
  }
}

TEST(TetrahedronQuality, OfTheCornerOfACube) {
  Eigen::Matrix<double, 3, 4> corners;
  corners << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  const TetrahedronQuality q = measure(one(corners), 0);
  EXPECT_NEAR(q.volume, 1.0 / 6, 1e-15);
  EXPECT_NEAR(q.largest_angle, EIGEN_PI / 2, 1e-12);
  EXPECT_NEAR(q.smallest_angle, std::acos(1 / std::sqrt(3.0)), 1e-12);
  // r_in = 1 / (3 + sqrt 3), r_out = sqrt(3) / 2.
  EXPECT_NEAR(q.radius_ratio, 3 / (3 + std::sqrt(3.0)) / (std::sqrt(3.0) / 2), 1e-12);
  EXPECT_NEAR(q.scaled_jacobian, std::sqrt(2.0) / 2, 1e-12);
  EXPECT_GT(q.stiffness, 1);
}

TEST(TetrahedronQuality, FallsToNothingAsOneIsFlattened) {
  double last = 0;
  for (const double height : {1e-1, 1e-3, 1e-6, 1e-9}) {
    Eigen::Matrix<double, 3, 4> corners;
    corners << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, height;
    const TetrahedronQuality q = measure(one(corners), 0);
    EXPECT_GT(q.stiffness, std::max(1.0, last));
    EXPECT_LT(q.radius_ratio, 20 * height);
    last = q.stiffness;
  }
  Eigen::Matrix<double, 3, 4> flat;
  flat << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0;
  const TetrahedronQuality q = measure(one(flat), 0);
  EXPECT_EQ(q.radius_ratio, 0);
  EXPECT_TRUE(std::isinf(q.stiffness));
}

TEST(RoundMesh, CylindersHaveTheirVolumeAndGoodElements) {
  for (const int rings : {1, 2, 4}) {
    for (const auto sides : {RoundSides::kFull, RoundSides::kCurved}) {
      const MeshWithGroups mesh = make_cylinder(0.025, 0.2, rings, 8 * rings, sides);
      const MeshReport report = check(mesh.mesh);
      ASSERT_TRUE(report.ok()) << report.text();
      EXPECT_EQ(report.non_manifold_edges.size() + report.non_manifold_nodes.size(), 0U);
      EXPECT_GT(report.quality_min, 0.6);
      const double exact = EIGEN_PI * 0.025 * 0.025 * 0.2;
      if (sides == RoundSides::kFull) {
        EXPECT_NEAR(report.volume, exact, 1e-12 * exact);
      } else {
        // Parabolas for arcs of 60 degrees per element: the error is of fourth order.
        EXPECT_NEAR(curved_volume(mesh.mesh, mesh.middles), exact,
                    0.004 / std::pow(rings, 4) * exact);
      }
      for (const int n : mesh.groups.at("x_min").nodes) EXPECT_EQ(mesh.mesh.nodes(0, n), 0);
      EXPECT_EQ(mesh.groups.at("x_min").triangles.cols(), 6 * rings * rings);
      EXPECT_EQ(mesh.groups.at("side").triangles.cols(), 2 * 6 * rings * 8 * rings);
    }
  }
}

TEST(RoundMesh, EllipsoidsHaveTheirVolumeAndGoodElements) {
  for (const int cells : {1, 2, 4}) {
    for (const auto sides : {RoundSides::kFull, RoundSides::kCurved}) {
      const MeshWithGroups mesh = make_ellipsoid({0.05, 0.03, 0.03}, cells, sides);
      const MeshReport report = check(mesh.mesh);
      ASSERT_TRUE(report.ok()) << report.text();
      EXPECT_EQ(report.tetrahedron_count, 20 * cells * cells * cells);
      EXPECT_GT(report.quality_min, 0.3);
      const double exact = 4 * EIGEN_PI / 3 * 0.05 * 0.03 * 0.03;
      const double volume =
          sides == RoundSides::kFull ? report.volume : curved_volume(mesh.mesh, mesh.middles);
      EXPECT_NEAR(volume, exact,
                  (sides == RoundSides::kFull ? 1e-12 : 0.05 / std::pow(cells, 4)) * exact);
      EXPECT_EQ(mesh.groups.at("surface").triangles.cols(), 20 * cells * cells);
    }
  }
}

TEST(RoundMesh, RefusesWhatIsNoBody) {
  EXPECT_THROW(make_cylinder(0, 1, 1, 1, RoundSides::kFull), std::invalid_argument);
  EXPECT_THROW(make_cylinder(1, 1, 0, 1, RoundSides::kFull), std::invalid_argument);
  EXPECT_THROW(make_ellipsoid({1, 1, -1}, 1, RoundSides::kFull), std::invalid_argument);
  EXPECT_THROW(make_ellipsoid({1, 1, 1}, 0, RoundSides::kFull), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::mesh
