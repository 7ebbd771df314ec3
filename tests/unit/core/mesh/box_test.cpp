#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/mesh/surface.hpp"

namespace palpate::mesh {
namespace {

const Eigen::Vector3d kSize(0.3, 0.2, 0.1);

TEST(Box, FillsItsVolumeWithPositiveTetrahedra) {
  const TetrahedralMesh mesh = make_box(kSize, {3, 2, 4});
  EXPECT_EQ(mesh.node_count(), 4 * 3 * 5);
  EXPECT_EQ(mesh.tetrahedron_count(), 6 * 3 * 2 * 4);
  double total = 0;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    EXPECT_NEAR(volume(mesh, t), kSize.prod() / 144, 1e-18);
    total += volume(mesh, t);
  }
  EXPECT_NEAR(total, kSize.prod(), 1e-15);
  EXPECT_EQ(mesh.nodes.rowwise().minCoeff(), Eigen::Vector3d::Zero());
  EXPECT_EQ(mesh.nodes.rowwise().maxCoeff(), kSize);
}

TEST(Box, RefusesNonsense) {
  EXPECT_THROW(make_box({0, 1, 1}, {1, 1, 1}), std::invalid_argument);
  EXPECT_THROW(make_box({1, 1, 1}, {1, 0, 1}), std::invalid_argument);
}

TEST(Orient, TurnsNegativeTetrahedra) {
  TetrahedralMesh mesh = make_box(kSize, {1, 1, 1});
  const TetrahedralMesh good = mesh;
  EXPECT_EQ(orient(mesh), 0);
  EXPECT_EQ(mesh.tetrahedra, good.tetrahedra);
  for (const int t : {1, 4}) std::swap(mesh.tetrahedra(0, t), mesh.tetrahedra(3, t));
  EXPECT_LT(volume(mesh, 4), 0);
  EXPECT_EQ(orient(mesh), 2);
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) EXPECT_GT(volume(mesh, t), 0);
}

TEST(Hash, NamesNodesAndIndices) {
  const TetrahedralMesh mesh = make_box(kSize, {2, 1, 1});
  EXPECT_EQ(hash(mesh), hash(make_box(kSize, {2, 1, 1})));
  TetrahedralMesh moved = mesh;
  moved.nodes(1, 3) += 1e-15;
  EXPECT_NE(hash(moved), hash(mesh));
  TetrahedralMesh renumbered = mesh;
  renumbered.tetrahedra.col(0).swap(renumbered.tetrahedra.col(1));
  EXPECT_NE(hash(renumbered), hash(mesh));
}

TEST(ElementMesh, LinearIsTheMeshItself) {
  const TetrahedralMesh box = make_box(kSize, {2, 1, 1});
  const ElementMesh mesh = make_element_mesh(box, ElementOrder::kLinear);
  EXPECT_EQ(mesh.nodes, box.nodes);
  EXPECT_EQ(mesh.elements, box.tetrahedra);
  EXPECT_EQ(mesh.corner_count, box.node_count());
}

TEST(ElementMesh, QuadraticHasOneNodeInTheMiddleOfEachEdge) {
  const TetrahedralMesh box = make_box(kSize, {2, 3, 1});
  const ElementMesh mesh = make_element_mesh(box, ElementOrder::kQuadratic);
  EXPECT_EQ(mesh.nodes_per_element(), 10);
  EXPECT_EQ(mesh.corner_count, box.node_count());
  EXPECT_EQ(mesh.nodes.leftCols(box.node_count()), box.nodes);
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int m = 0; m < 6; ++m) {
      const Eigen::Vector3d middle =
          0.5 * (mesh.nodes.col(mesh.elements(kTetrahedronEdges[m][0], e)) +
                 mesh.nodes.col(mesh.elements(kTetrahedronEdges[m][1], e)));
      EXPECT_LT((mesh.nodes.col(mesh.elements(4 + m, e)) - middle).norm(), 1e-16);
    }
  }
  // Euler: nodes - edges + faces - tetrahedra = 1 for a ball; interior faces count twice.
  const int edges = mesh.node_count() - mesh.corner_count;
  const int boundary = static_cast<int>(
      extract_surface(make_element_mesh(box, ElementOrder::kLinear)).triangles.cols());
  const int faces = (4 * box.tetrahedron_count() + boundary) / 2;
  EXPECT_EQ(box.node_count() - edges + faces - box.tetrahedron_count(), 1);
}

class SurfaceOfBox : public ::testing::TestWithParam<ElementOrder> {};

TEST_P(SurfaceOfBox, IsClosedAndPointsOutward) {
  const ElementMesh mesh = make_element_mesh(make_box(kSize, {3, 2, 2}), GetParam());
  const Surface surface = extract_surface(mesh);
  EXPECT_EQ(surface.triangles.cols(), 2 * 2 * (3 * 2 + 3 * 2 + 2 * 2));
  double enclosed = 0;
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  double total_area = 0;
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d a = mesh.nodes.col(surface.triangles(0, t));
    const Eigen::Vector3d b = mesh.nodes.col(surface.triangles(1, t));
    const Eigen::Vector3d c = mesh.nodes.col(surface.triangles(2, t));
    const Eigen::Vector3d n = 0.5 * (b - a).cross(c - a);
    EXPECT_GT(n.dot(a - 0.5 * kSize), 0) << t;
    enclosed += a.dot(n) / 3;
    area += n;
    total_area += n.norm();
  }
  EXPECT_NEAR(enclosed, kSize.prod(), 1e-15);
  EXPECT_LT(area.norm(), 1e-15);
  EXPECT_NEAR(total_area, 2 * (0.3 * 0.2 + 0.3 * 0.1 + 0.2 * 0.1), 1e-14);
}

TEST_P(SurfaceOfBox, NodesAreThoseOnTheBoundary) {
  const ElementMesh mesh = make_element_mesh(make_box(kSize, {3, 2, 2}), GetParam());
  const Surface surface = extract_surface(mesh);
  std::vector<int> expected;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Eigen::Array3d p = mesh.nodes.col(n);
    if ((p < 1e-12).any() || (p > kSize.array() - 1e-12).any()) expected.push_back(n);
  }
  EXPECT_EQ(surface.nodes, expected);
}

TEST_P(SurfaceOfBox, MidsideNodesFollowTheirCorners) {
  const ElementMesh mesh = make_element_mesh(make_box(kSize, {2, 2, 1}), GetParam());
  const Surface surface = extract_surface(mesh);
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const std::vector<int>& nodes = surface.triangle_nodes[t];
    for (int i = 0; i < 3; ++i) EXPECT_EQ(nodes[i], surface.triangles(i, t));
    if (GetParam() == ElementOrder::kLinear) {
      EXPECT_EQ(nodes.size(), 3u);
      continue;
    }
    ASSERT_EQ(nodes.size(), 6u);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d middle =
          0.5 * (mesh.nodes.col(nodes[i]) + mesh.nodes.col(nodes[(i + 1) % 3]));
      EXPECT_LT((mesh.nodes.col(nodes[3 + i]) - middle).norm(), 1e-16);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, SurfaceOfBox,
                         ::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic));

TEST(NodesInBox, TakesTheFaceOfABar) {
  const ElementMesh mesh = make_element_mesh(make_box(kSize, {3, 2, 2}), ElementOrder::kQuadratic);
  const std::vector<int> face = nodes_in_box(mesh, {0, 0, 0}, {0, 0.2, 0.1});
  EXPECT_EQ(face.size(), 5u * 5u);  // 3 x 3 corners with what lies between
  for (const int n : face) EXPECT_EQ(mesh.nodes(0, n), 0);
  EXPECT_TRUE(nodes_in_box(mesh, {1, 1, 1}, {2, 2, 2}).empty());
}

}  // namespace
}  // namespace palpate::mesh
