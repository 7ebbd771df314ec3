// What selects faces and elements, on a bar of cells of 50 mm and on a sphere: numbers and areas
// are those of the cells and of the body.

#include "tools/mesh/region_selection.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/round_mesh.hpp"

namespace palpate::mesh_tool {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = EIGEN_PI / 180;

struct Selected {
  explicit Selected(mesh::TetrahedralMesh made)
      : mesh(std::move(made)), faces(mesh::extract_surface(mesh).triangles), of(mesh, faces) {}
  double area(const std::vector<int>& chosen) const {
    double sum = 0;
    for (const int f : chosen) sum += of.area(f);
    return sum;
  }

  mesh::TetrahedralMesh mesh;
  Eigen::Matrix3Xi faces;
  RegionSelection of;
};

/// 8 x 2 x 2 cells, six tetrahedra each: 2 triangles on each of the 72 squares of the boundary.
Selected bar() { return Selected(mesh::make_box({0.4, 0.1, 0.1}, {8, 2, 2})); }

TEST(RegionSelection, BoxesHoldWholeFacesAndCentroidsOfElements) {
  const Selected bar = mesh_tool::bar();
  ASSERT_EQ(bar.of.all(RegionKind::kFaces).size(), 144u);
  EXPECT_NEAR(bar.area(bar.of.all(RegionKind::kFaces)), 0.18, 1e-12);
  // One end of 4 squares and four sides of 2 x 2.
  const Space end = box_space({0, 0, 0}, {0.1, 1, 1});
  const std::vector<int> faces = bar.of.inside(RegionKind::kFaces, end);
  EXPECT_EQ(faces.size(), 2u * (4 + 16));
  EXPECT_NEAR(bar.area(faces), 0.01 + 4 * 0.01, 1e-12);
  EXPECT_EQ(bar.of.inside(RegionKind::kElements, end).size(), 6u * 8);
  // A bound between rows of nodes holds the faces below it.
  EXPECT_EQ(bar.of.inside(RegionKind::kFaces, box_space({0, 0, 0}, {0.149, 1, 1})), faces);
  EXPECT_EQ(bar.of.inside(RegionKind::kFaces, half_space({0.1, 7, 7}, {-2, 0, 0})), faces);
  EXPECT_TRUE(bar.of.inside(RegionKind::kFaces, box_space({5, 0, 0}, {6, 1, 1})).empty());
}

TEST(RegionSelection, SpheresHoldWhatIsNearer) {
  const Selected bar = mesh_tool::bar();
  // About a corner of the bar: the three squares there, whose far corners are 70.7 mm away. Their
  // diagonals run along the axes from lower to higher coordinates.
  EXPECT_EQ(bar.of.inside(RegionKind::kFaces, ball_space({0, 0, 0}, 0.071)).size(), 6u);
  EXPECT_TRUE(bar.of.inside(RegionKind::kFaces, ball_space({0, 0, 0}, 0.0706)).empty());
  EXPECT_EQ(bar.of.inside(RegionKind::kFaces, ball_space({0.4, 0, 0}, 0.071)).size(), 6u);
  EXPECT_EQ(bar.of.inside(RegionKind::kFaces, ball_space({0.4, 0, 0}, 0.0706)).size(), 2u)
      << "the halves of two squares that lie at the corner";
}

TEST(RegionSelection, SidesFaceADirection) {
  const Selected bar = mesh_tool::bar();
  const std::vector<int> top = bar.of.facing({0, 0, 5}, 1 * kDegree);
  EXPECT_EQ(top.size(), 32u);
  EXPECT_NEAR(bar.area(top), 0.04, 1e-12);
  for (const int f : top) EXPECT_NEAR(bar.of.normal(f).z(), 1, 1e-12);
  EXPECT_EQ(bar.of.facing({0, 0, 1}, 90 * kDegree).size(), 144u - 32);
}

TEST(RegionSelection, ACapOfASphereHasItsArea) {
  constexpr double kRadius = 0.05, kAngle = 50 * kDegree;
  const Selected ball(
      mesh::make_ellipsoid(Vector3d::Constant(kRadius), 14, mesh::RoundSides::kFull).mesh);
  const double exact = 2 * EIGEN_PI * kRadius * kRadius * (1 - std::cos(kAngle));
  for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(0.3, -0.8, 0.5)}) {
    const std::vector<int> cap = ball.of.facing(direction, kAngle);
    EXPECT_NEAR(ball.area(cap), exact, 0.05 * exact);  // within half a face at its outline
    // It is connected, as the whole sphere is by its edges of few degrees.
    EXPECT_EQ(ball.of.connected(cap[0], 20 * kDegree).size(),
              static_cast<std::size_t>(ball.faces.cols()));
  }
}

TEST(RegionSelection, ConnectedFacesEndAtEdges) {
  const Selected bar = mesh_tool::bar();
  const int face = bar.of.nearest_face({0.21, 0.04, 0.13});
  EXPECT_NEAR(bar.of.normal(face).z(), 1, 1e-12);
  EXPECT_EQ(bar.of.connected(face, 89 * kDegree), bar.of.facing({0, 0, 1}, 1 * kDegree));
  EXPECT_EQ(bar.of.connected(face, 90 * kDegree).size(), 144u);
  // A brush paints what it reaches along the surface: nothing on the far side, however large it is.
  const std::vector<int> stroke =
      bar.of.connected(face, 30 * kDegree, ball_space({0.2, 0.05, 0.1}, 0.15));
  EXPECT_GT(stroke.size(), 16u);
  EXPECT_LT(stroke.size(), 32u);
  for (const int f : stroke) EXPECT_NEAR(bar.of.normal(f).z(), 1, 1e-12);
  EXPECT_EQ(bar.of.connected(face, 30 * kDegree, ball_space({9, 9, 9}, 1e-3)),
            std::vector<int>{face});
  EXPECT_THROW(bar.of.connected(144, 1), std::invalid_argument);
}

TEST(RegionSelection, GrowthIsARowOfCells) {
  const Selected bar = mesh_tool::bar();
  for (const RegionKind kind : {RegionKind::kFaces, RegionKind::kElements}) {
    const auto upto = [&](double x) {
      return bar.of.inside(kind, box_space({0, 0, 0}, {x, 1, 1}));
    };
    EXPECT_EQ(bar.of.grown(kind, upto(0.05), 0), upto(0.05));
    EXPECT_EQ(bar.of.grown(kind, upto(0.05), 1), upto(0.1));
    EXPECT_EQ(bar.of.grown(kind, upto(0.05), 3), upto(0.2));
    EXPECT_EQ(bar.of.grown(kind, upto(0.05), 50), bar.of.all(kind));
  }
}

TEST(RegionSelection, ElementsAtFacesHaveOneEach) {
  const Selected bar = mesh_tool::bar();
  const std::vector<int> end = bar.of.facing({-1, 0, 0}, 1 * kDegree);
  ASSERT_EQ(end.size(), 8u);
  const std::vector<int> elements = bar.of.elements_at(end);
  EXPECT_EQ(elements.size(), 8u) << "two of each cell's six";
  for (const int t : elements) {
    int at_end = 0;
    for (const int n : bar.mesh.tetrahedra.col(t)) at_end += bar.mesh.nodes(0, n) == 0 ? 1 : 0;
    EXPECT_EQ(at_end, 3);
  }
}

TEST(RegionSelection, ARectangleHoldsWhatTheViewerSees) {
  const Selected bar = mesh_tool::bar();
  // From 1 m above the middle of the bar, x to the right and y up.
  Eigen::Matrix4d clip_from_object;
  clip_from_object << 1, 0, 0, -0.2, 0, 1, 0, -0.05, 0, 0, 0, 0, 0, 0, -1, 1;
  EXPECT_EQ(bar.of.seen(RegionKind::kFaces, clip_from_object, {-1, -1}, {1, 1}),
            bar.of.facing({0, 0, 1}, 1 * kDegree));
  EXPECT_EQ(bar.of.seen(RegionKind::kFaces, clip_from_object, {-1e-9, -1}, {1, 1}).size(), 16u);
  EXPECT_EQ(bar.of.seen(RegionKind::kElements, clip_from_object, {0, -1}, {1, 1}).size(),
            4u * 2 * 2 * 6);
  // The viewer is inside the bar's plane of z = 1: what is behind is not in the image.
  clip_from_object(3, 2) = 1;
  clip_from_object(3, 3) = -1;
  EXPECT_TRUE(bar.of.seen(RegionKind::kElements, clip_from_object, {-9, -9}, {9, 9}).empty());
}

TEST(RegionSelection, PlacesThatAreNoneAreRefused) {
  EXPECT_THROW(box_space({0, 1, 0}, {1, 0, 1}), std::invalid_argument);
  EXPECT_THROW(ball_space({0, 0, 0}, 0), std::invalid_argument);
  EXPECT_THROW(half_space({0, 0, 0}, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(bar().of.facing({0, 0, 0}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::mesh_tool
