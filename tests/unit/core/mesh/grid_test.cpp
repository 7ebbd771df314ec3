#include "core/mesh/grid_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/mesh/element_mesh.hpp"

namespace palpate::mesh {
namespace {

const GridPlanes kPlanes{{{-0.1, 0, 0.3, 0.4}, {0, 0.2, 0.25}, {0.5, 0.6, 0.8}}};

class Grid : public testing::TestWithParam<CellCut> {};

double total_volume(const TetrahedralMesh& mesh) {
  double total = 0;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    EXPECT_GT(volume(mesh, t), 0) << t;
    total += volume(mesh, t);
  }
  return total;
}

/// Number of tetrahedra at each face; conforming neighbours share all faces but those of the
/// boundary.
std::map<int, int> faces_by_owners(const TetrahedralMesh& mesh) {
  std::map<std::array<int, 3>, int> owners;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    for (int left_out = 0; left_out < 4; ++left_out) {
      std::array<int, 3> face{};
      for (int i = 0; i < 3; ++i) face[i] = mesh.tetrahedra((left_out + 1 + i) % 4, t);
      std::sort(face.begin(), face.end());
      ++owners[face];
    }
  }
  std::map<int, int> result;
  for (const auto& [face, count] : owners) ++result[count];
  return result;
}

TEST_P(Grid, FillsTheBoxWithMatchingTetrahedra) {
  const TetrahedralMesh mesh = make_grid(kPlanes, GetParam());
  EXPECT_EQ(mesh.node_count(), 4 * 3 * 3);
  EXPECT_EQ(mesh.tetrahedron_count(), (GetParam() == CellCut::kSix ? 6 : 5) * 3 * 2 * 2);
  EXPECT_NEAR(total_volume(mesh), 0.5 * 0.25 * 0.3, 1e-15);
  const std::map<int, int> faces = faces_by_owners(mesh);
  EXPECT_EQ(faces.at(1), 2 * 2 * (3 * 2 + 3 * 2 + 2 * 2));
  EXPECT_EQ(faces.size(), 2u);
  EXPECT_EQ(faces.rbegin()->first, 2);
}

TEST_P(Grid, LeavesOutCellsAndTheirNodes) {
  // An L: without the cells beyond x = 0.3 and y = 0.2.
  const TetrahedralMesh mesh = make_grid(
      kPlanes, GetParam(), [](const Eigen::Vector3d& p) { return p.x() < 0.3 || p.y() < 0.2; });
  EXPECT_EQ(mesh.node_count(), 4 * 3 * 3 - 3);
  EXPECT_NEAR(total_volume(mesh), (0.5 * 0.25 - 0.1 * 0.05) * 0.3, 1e-15);
  EXPECT_EQ(faces_by_owners(mesh).size(), 2u);
  EXPECT_LT(mesh.tetrahedra.maxCoeff(), mesh.node_count());
  EXPECT_THROW(make_grid(kPlanes, GetParam(), [](const Eigen::Vector3d&) { return false; }),
               std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Cuts, Grid, testing::Values(CellCut::kSix, CellCut::kFive));

TEST(Grid, OfFiveTetrahedraHasOneEdgeLessPerCell) {
  const auto edges = [](CellCut cut) {
    const ElementMesh mesh = make_element_mesh(make_grid(kPlanes, cut), ElementOrder::kQuadratic);
    return mesh.node_count() - mesh.corner_count;
  };
  EXPECT_EQ(edges(CellCut::kSix) - edges(CellCut::kFive), 3 * 2 * 2);
}

TEST(Grid, RefusesPlanesThatDoNotRise) {
  GridPlanes planes = kPlanes;
  planes[1] = {0, 0.2, 0.2};
  EXPECT_THROW(make_grid(planes, CellCut::kSix), std::invalid_argument);
  planes[1] = {0};
  EXPECT_THROW(make_grid(planes, CellCut::kSix), std::invalid_argument);
}

std::vector<double> aligned(std::vector<double> planes, const std::vector<double>& through) {
  align(through, planes);
  return planes;
}

void expect_planes(const std::vector<double>& planes, const std::vector<double>& expected) {
  ASSERT_EQ(planes.size(), expected.size());
  for (std::size_t i = 0; i < planes.size(); ++i) EXPECT_NEAR(planes[i], expected[i], 1e-15) << i;
}

TEST(Align, MovesTheNearestPlanesAndSpacesTheOthersEvenly) {
  expect_planes(aligned({0, 1, 2, 3, 4, 5}, {3.3}), {0, 1.1, 2.2, 3.3, 4.15, 5});
  expect_planes(aligned({0, 1, 2, 3, 4, 5}, {4.8, 0.1}),
                {0, 0.1, 0.1 + 4.7 / 3, 0.1 + 9.4 / 3, 4.8, 5});
  expect_planes(aligned({0, 1, 2, 3}, {2}), {0, 1, 2, 3});
}

TEST(Align, KeepsPlanesInOrderWhereSeveralCoordinatesAreNearOne) {
  expect_planes(aligned({0, 1, 2, 3}, {1.9, 2.1}), {0, 1.9, 2.1, 3});
  expect_planes(aligned({0, 1, 2, 3}, {0.9, 1.0, 1.1}), {0, 0.9, 1.0, 3});  // one too many
}

TEST(Align, IgnoresCoordinatesWithoutAnInnerPlane) {
  expect_planes(aligned({0, 1}, {0.5}), {0, 1});
  expect_planes(aligned({0, 1, 2}, {0, 2, -1, 7}), {0, 1, 2});
}

}  // namespace
}  // namespace palpate::mesh
