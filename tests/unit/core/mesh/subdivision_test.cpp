#include "core/mesh/subdivision.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/mesh/surface.hpp"

namespace palpate::mesh {
namespace {

TetrahedralMesh small_box() { return make_box({0.1, 0.06, 0.04}, {3, 2, 1}); }

double sum_of_volumes(const TetrahedralMesh& mesh) {
  double sum = 0;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) sum += volume(mesh, t);
  return sum;
}

TEST(Subdivision, EightEqualPartsOfEachTetrahedron) {
  const TetrahedralMesh mesh = small_box();
  const TetrahedralMesh fine = subdivide(mesh);
  ASSERT_EQ(fine.tetrahedron_count(), 8 * mesh.tetrahedron_count());
  for (int t = 0; t < fine.tetrahedron_count(); ++t) {
    const double whole = volume(mesh, t / 8);
    EXPECT_NEAR(volume(fine, t), whole / 8, 1e-12 * whole);
  }
}

TEST(Subdivision, NodesOfTheMeshComeFirst) {
  const TetrahedralMesh mesh = small_box();
  const TetrahedralMesh fine = subdivide(subdivide(mesh));
  EXPECT_EQ(fine.nodes.leftCols(mesh.node_count()), mesh.nodes);
}

/// Faces of neighbours match: the boundary has four triangles for each one, and its area.
TEST(Subdivision, IsConforming) {
  const TetrahedralMesh mesh = small_box();
  const TetrahedralMesh fine = subdivide(mesh);
  const Surface coarse_surface = extract_surface(mesh), surface = extract_surface(fine);
  EXPECT_EQ(surface.triangles.cols(), 4 * coarse_surface.triangles.cols());
  double area = 0;
  for (int i = 0; i < surface.triangles.cols(); ++i) {
    const Eigen::Vector3d a = fine.nodes.col(surface.triangles(0, i));
    const Eigen::Vector3d b = fine.nodes.col(surface.triangles(1, i));
    const Eigen::Vector3d c = fine.nodes.col(surface.triangles(2, i));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  EXPECT_NEAR(area, 2 * (0.1 * 0.06 + 0.06 * 0.04 + 0.04 * 0.1), 1e-12);
  EXPECT_EQ(fine.node_count(), 7 * 5 * 3);  // of a grid of half the width
}

TEST(Subdivision, CurvedMiddlesAreKept) {
  ElementMesh quadratic = make_element_mesh(small_box(), ElementOrder::kQuadratic);
  quadratic.nodes.col(quadratic.corner_count) += Eigen::Vector3d(1e-3, -1e-3, 5e-4);
  const TetrahedralMesh fine = subdivide(quadratic);
  EXPECT_EQ(fine.nodes, quadratic.nodes);
  EXPECT_LE(sum_of_volumes(fine), total_volume(small_box()) * 1.02);
}

TEST(Subdivision, LinearElementsAreRejected) {
  EXPECT_THROW(subdivide(make_element_mesh(small_box(), ElementOrder::kLinear)),
               std::invalid_argument);
}

}  // namespace
}  // namespace palpate::mesh
