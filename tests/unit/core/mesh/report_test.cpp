#include "core/mesh/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace palpate::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TetrahedralMesh single(const Eigen::Matrix<double, 3, 4>& corners) {
  TetrahedralMesh mesh;
  mesh.nodes = corners;
  mesh.tetrahedra.resize(4, 1);
  mesh.tetrahedra.col(0) << 0, 1, 2, 3;
  return mesh;
}

TEST(RadiusRatio, IsOneForARegularTetrahedronOfAnySize) {
  Eigen::Matrix<double, 3, 4> corners;
  corners << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  EXPECT_NEAR(radius_ratio(single(corners), 0), 1, 1e-14);
  EXPECT_NEAR(radius_ratio(single(1e-4 * corners), 0), 1, 1e-13);
}

TEST(RadiusRatio, OfTheCornerTetrahedronIsKnown) {
  // Legs 1: r_in = 1 / (3 + sqrt 3), r_out = sqrt(3) / 2.
  Eigen::Matrix<double, 3, 4> corners;
  corners << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_NEAR(radius_ratio(single(corners), 0), 6 / ((3 + std::sqrt(3)) * std::sqrt(3)), 1e-14);
  corners(2, 3) = 0;
  EXPECT_EQ(radius_ratio(single(corners), 0), 0);
}

TEST(MeshReport, AGoodMeshIsOk) {
  const MeshReport report = check(make_box({0.5, 0.06, 0.06}, {10, 2, 2}));
  EXPECT_TRUE(report.ok()) << report.text();
  EXPECT_NEAR(report.volume, 0.5 * 0.06 * 0.06, 1e-15);
  EXPECT_EQ(report.parts, 1);
  EXPECT_TRUE(report.non_manifold_edges.empty());
  EXPECT_GT(report.quality_min, 0);
  EXPECT_LE(report.quality_min, report.quality_mean);
  EXPECT_LT(report.quality_mean, 1);
  EXPECT_THAT(report.text(), HasSubstr("99 nodes, 240 tetrahedra"));
  EXPECT_THAT(report.text(), Not(HasSubstr(";")));
}

TEST(MeshReport, AnEmptyMeshIsNotOk) { EXPECT_FALSE(check(TetrahedralMesh()).ok()); }

class BrokenMesh : public ::testing::Test {
 protected:
  MeshReport report() {
    const MeshReport report = check(mesh_);
    EXPECT_FALSE(report.ok());
    EXPECT_THAT(report.text(), HasSubstr(";"));
    return report;
  }
  TetrahedralMesh mesh_ = make_box({1, 1, 1}, {2, 2, 2});
};

TEST_F(BrokenMesh, IndexOutOfRange) {
  mesh_.tetrahedra(2, 5) = mesh_.node_count();
  mesh_.tetrahedra(0, 7) = -1;
  EXPECT_THAT(report().index_out_of_range, ElementsAre(5, 7));
}

TEST_F(BrokenMesh, CoordinateNotFinite) {
  mesh_.nodes(1, 4) = std::numeric_limits<double>::quiet_NaN();
  mesh_.nodes(0, 9) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(report().not_finite, ElementsAre(4, 9));
}

TEST_F(BrokenMesh, NegativeVolume) {
  std::swap(mesh_.tetrahedra(0, 3), mesh_.tetrahedra(1, 3));
  EXPECT_THAT(report().negative_volume, ElementsAre(3));
  orient(mesh_);
  EXPECT_TRUE(check(mesh_).ok());
}

TEST_F(BrokenMesh, ZeroVolume) {
  mesh_.tetrahedra(3, 8) = mesh_.tetrahedra(2, 8);
  EXPECT_THAT(report().zero_volume, ElementsAre(8));
}

TEST_F(BrokenMesh, UnusedAndDuplicateNodes) {
  const int count = mesh_.node_count();
  mesh_.nodes.conservativeResize(3, count + 2);
  mesh_.nodes.col(count) << 5, 5, 5;
  mesh_.nodes.col(count + 1) = mesh_.nodes.col(3) + Eigen::Vector3d::Constant(1e-11);
  EXPECT_THAT(report().unused_nodes, ElementsAre(count, count + 1));
  EXPECT_THAT(report().duplicate_nodes, ElementsAre(count + 1));
}

TEST_F(BrokenMesh, PartsThatDoNotTouch) {
  const int count = mesh_.node_count();
  mesh_.nodes.conservativeResize(3, count + 4);
  for (int i = 0; i < 4; ++i) {
    mesh_.nodes.col(count + i) = Eigen::Vector3d::Constant(3);
    if (i > 0) mesh_.nodes(i - 1, count + i) += 1;
  }
  const int last = mesh_.tetrahedron_count();
  mesh_.tetrahedra.conservativeResize(4, last + 1);
  mesh_.tetrahedra.col(last) << count, count + 1, count + 2, count + 3;
  EXPECT_EQ(report().parts, 2);
}

TEST(MeshReport, AHingeIsReportedButNotAnError) {
  // Two tetrahedra that share the edge from node 0 to node 1 and nothing else.
  TetrahedralMesh mesh;
  mesh.nodes.resize(3, 6);
  mesh.nodes << 0, 0, 1, 1, -1, -1,  //
      0, 0, 1, -1, 1, -1,            //
      0, 1, 0, 0, 0, 0;
  mesh.tetrahedra.resize(4, 2);
  mesh.tetrahedra << 0, 0, 1, 1, 2, 4, 3, 5;
  orient(mesh);
  const MeshReport report = check(mesh);
  EXPECT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(report.parts, 1);
  EXPECT_EQ(report.non_manifold_edges.size(), 1U);
  EXPECT_THAT(report.text(), HasSubstr("non-manifold"));
}

}  // namespace
}  // namespace palpate::mesh
