// Surfaces: files, every class of fault found and repaired or kept, and nothing reported for valid
// ones.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <sstream>

#include "core/mesh/round_mesh.hpp"
#include "core/mesh/surface.hpp"
#include "core/mesh/surface_files.hpp"
#include "core/mesh/surface_repair.hpp"
#include "core/mesh/surface_report.hpp"
#include "tests/unit/core/mesh/random_meshes.hpp"

namespace palpate::mesh {
namespace {

using ::testing::HasSubstr;

TriangleSurface boundary_of(const TetrahedralMesh& mesh) {
  const Surface outside = extract_surface(make_element_mesh(mesh, ElementOrder::kLinear));
  TriangleSurface surface;
  std::vector<int> number(mesh.node_count(), -1);
  surface.points = mesh.nodes(Eigen::all, outside.nodes);
  for (std::size_t i = 0; i < outside.nodes.size(); ++i)
    number[outside.nodes[i]] = static_cast<int>(i);
  surface.triangles = outside.triangles.unaryExpr([&](int n) { return number[n]; });
  return surface;
}

TriangleSurface ball(double radius = 0.05, const Eigen::Vector3d& centre = {0, 0, 0},
                     int cells = 3) {
  TriangleSurface surface =
      boundary_of(make_ellipsoid(Eigen::Vector3d::Constant(radius), cells, RoundSides::kFull).mesh);
  surface.points.colwise() += centre;
  return surface;
}

void append(const TriangleSurface& other, TriangleSurface& surface) {
  const int points = surface.point_count(), triangles = surface.triangle_count();
  surface.points.conservativeResize(3, points + other.point_count());
  surface.points.rightCols(other.point_count()) = other.points;
  surface.triangles.conservativeResize(3, triangles + other.triangle_count());
  surface.triangles.rightCols(other.triangle_count()) = other.triangles.array() + points;
}

void flip(TriangleSurface& surface, int t) {
  std::swap(surface.triangles(0, t), surface.triangles(1, t));
}

void remove(TriangleSurface& surface, int t) {
  surface.triangles.col(t) = surface.triangles.rightCols<1>().eval();
  surface.triangles = surface.triangles.leftCols(surface.triangle_count() - 1).eval();
}

TEST(SurfaceReport, NothingIsSaidOfGoodOnes) {
  RandomMeshes random(1);
  for (int i = 0; i < 200; ++i) {
    const TriangleSurface surface = boundary_of(random.make());
    const SurfaceReport report = check(surface);
    ASSERT_TRUE(report.ok()) << i;
    ASSERT_TRUE(report.intersections.empty());
    ASSERT_NEAR(report.volume, enclosed_volume(surface), 1e-12 * report.volume);
  }
  EXPECT_TRUE(check(ball()).ok());
}

TEST(SurfaceRepair, RandomBreakagesAreRepairedAndTheVolumeIsKept) {
  RandomMeshes random(2);
  for (int i = 0; i < 200; ++i) {
    TriangleSurface surface = boundary_of(random.make());
    const double volume = enclosed_volume(surface);
    const int kind = i % 5;
    if (kind == 0) {  // some reversed
      for (int k = 0; k < 3; ++k) flip(surface, random.below(surface.triangle_count()));
    } else if (kind == 1) {  // inverted
      for (int t = 0; t < surface.triangle_count(); ++t) flip(surface, t);
    } else if (kind == 2) {  // duplicated
      surface.triangles.conservativeResize(3, surface.triangle_count() + 1);
      surface.triangles.rightCols<1>() =
          surface.triangles.col(random.below(surface.triangle_count() - 1)).reverse().eval();
    } else if (kind == 3) {  // separated along all edges, as STL stores it, and rounded
      TriangleSurface torn;
      torn.points.resize(3, 3 * surface.triangle_count());
      torn.triangles.resize(3, surface.triangle_count());
      for (int t = 0; t < surface.triangle_count(); ++t) {
        for (int c = 0; c < 3; ++c) {
          torn.triangles(c, t) = 3 * t + c;
          torn.points.col(3 * t + c) =
              surface.points.col(surface.triangles(c, t)).cast<float>().cast<double>() *
              (1 + 1e-9 * c);
        }
      }
      surface = torn;
    } else {  // unreferenced points
      surface.points.conservativeResize(3, surface.point_count() + 2);
      surface.points.rightCols<2>().setConstant(7);
    }
    ASSERT_FALSE(check(surface).ok() && kind != 0) << i;
    const std::vector<RepairStep> steps = repair(surface, {});
    ASSERT_TRUE(check(surface).ok()) << i;
    ASSERT_NEAR(enclosed_volume(surface), volume, (kind == 3 ? 1e-5 : 1e-12) * volume) << i;
    ASSERT_TRUE(kind == 0 || !steps.empty());
    ASSERT_EQ(surface.numbers.size(), static_cast<std::size_t>(surface.triangle_count()));
  }
}

TEST(SurfaceRepair, ClosesSmallHolesInPlaneSidesExactly) {
  RandomMeshes random(3);
  for (int i = 0; i < 50; ++i) {
    TriangleSurface surface = boundary_of(make_box({0.1, 0.1, 0.1}, {3, 3, 3}));
    remove(surface, random.below(surface.triangle_count()));
    const SurfaceReport report = check(surface);
    ASSERT_EQ(report.holes.size(), 1u);
    ASSERT_EQ(report.holes[0].size(), 3u);
    const std::vector<RepairStep> steps = repair(surface, {});
    ASSERT_TRUE(check(surface).ok());
    ASSERT_NEAR(enclosed_volume(surface), 1e-3, 1e-15);
    ASSERT_THAT(steps.at(0).what, HasSubstr("close 1 hole"));
  }
  TriangleSurface surface = ball();
  remove(surface, 5);
  SurfaceRepairOptions none;
  none.largest_hole = 0;
  repair(surface, none);
  EXPECT_EQ(check(surface).holes.size(), 1u);
}

TEST(SurfaceRepair, TurnsTheEdgeUnderATriangleWithoutArea) {
  // A box corner on the middle of a neighbour's edge: a T-junction.
  TriangleSurface surface = boundary_of(make_box({1, 1, 1}, {1, 1, 1}));
  const Eigen::Vector3i c = surface.triangles.col(0);
  surface.points.conservativeResize(3, 9);
  surface.points.col(8) = 0.5 * (surface.points.col(c[0]) + surface.points.col(c[1]));
  surface.triangles.conservativeResize(3, 14);
  surface.triangles.col(0) << c[0], 8, c[2];
  surface.triangles.col(12) << 8, c[1], c[2];
  surface.triangles.col(13) << c[0], c[1], 8;  // closes the slit, flat
  ASSERT_EQ(check(surface).no_area, std::vector<int>{13});
  repair(surface, {});
  EXPECT_TRUE(check(surface).ok());
  EXPECT_NEAR(enclosed_volume(surface), 1, 1e-15);
}

TEST(SurfaceRepair, KeepsCavitiesAndDropsOtherPartsWhereAsked) {
  TriangleSurface hollow = ball();
  TriangleSurface inner = ball(0.02);
  append(inner, hollow);  // the inner one wrongly oriented: outward
  EXPECT_EQ(check(hollow).bodies, 1);
  EXPECT_EQ(check(hollow).inside_out, std::vector<int>{1});
  repair(hollow, {});
  EXPECT_TRUE(check(hollow).ok());
  EXPECT_NEAR(enclosed_volume(hollow), 4 * EIGEN_PI / 3 * (1.25e-4 - 8e-6), 1e-12);

  TriangleSurface two = ball();
  append(ball(0.02, {0.2, 0, 0}), two);
  EXPECT_EQ(check(two).bodies, 2);
  TriangleSurface kept = two;
  repair(kept, {});
  EXPECT_FALSE(check(kept).ok());
  SurfaceRepairOptions largest;
  largest.parts = Parts::kKeepLargest;
  repair(two, largest);
  EXPECT_TRUE(check(two).ok());
  EXPECT_NEAR(enclosed_volume(two), 4 * EIGEN_PI / 3 * 1.25e-4, 1e-12);
}

TEST(SurfaceReport, FindsWhatCannotBeRepaired) {
  TriangleSurface crossed = ball();
  append(ball(0.04, {0.06, 0.003, 0.002}), crossed);
  EXPECT_GT(check(crossed).intersections.size(), 10u);

  TriangleSurface pushed = ball(0.05, {0, 0, 0}, 5);
  pushed.points.col(0) = -0.98 * pushed.points.col(0);  // a spike through to the opposite side
  EXPECT_TRUE(check(pushed).intersections.empty());
  pushed.points.col(0) *= 1.1;
  EXPECT_FALSE(check(pushed).intersections.empty());

  TriangleSurface sheet = ball();
  sheet.points.conservativeResize(3, sheet.point_count() + 1);
  sheet.points.rightCols<1>() = Eigen::Vector3d(0.1, 0.1, 0.1);
  sheet.triangles.conservativeResize(3, sheet.triangle_count() + 1);
  sheet.triangles.rightCols<1>() << sheet.triangles(0, 0), sheet.triangles(1, 0),
      sheet.point_count() - 1;
  EXPECT_EQ(check(sheet).non_manifold_edges.size(), 1u);
  repair(sheet, {});
  EXPECT_FALSE(check(sheet).ok());

  // Two balls that share one point.
  TriangleSurface pinched = ball();
  int top = 0;
  pinched.points.row(0).maxCoeff(&top);
  const double radius = pinched.points(0, top);
  TriangleSurface other = ball(0.05, {2 * radius, 0, 0});
  append(other, pinched);
  repair(pinched, {});
  EXPECT_EQ(check(pinched).non_manifold_points.size(), 1u);

  TriangleSurface lost = ball();
  lost.triangles(1, 4) = -1;
  repair(lost, {});
  EXPECT_EQ(check(lost).index_out_of_range.size(), 1u);
  lost = ball();
  lost.points(2, 3) = NAN;
  repair(lost, {});
  EXPECT_EQ(check(lost).not_finite.size(), 1u);

  // A band with one twist (Moebius strip).
  TriangleSurface band;
  band.points.resize(3, 12);
  for (int i = 0; i < 6; ++i) {
    const double angle = EIGEN_PI * i / 3;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d across =
        0.3 * (std::cos(angle / 2) * Eigen::Vector3d::UnitZ() + std::sin(angle / 2) * out);
    band.points.col(2 * i) = out + across;
    band.points.col(2 * i + 1) = out - across;
  }
  band.triangles.resize(3, 12);
  for (int i = 0; i < 6; ++i) {
    const bool last = i == 5;
    const int a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    band.triangles.col(2 * i) << a, b, c;
    band.triangles.col(2 * i + 1) << c, b, d;
  }
  EXPECT_EQ(check(band).one_sided.size(), 1u);
}

TEST(Intersections, OfTrianglesInAllWays) {
  const auto meet = [](const Eigen::Matrix<double, 3, 6>& points) {
    TriangleSurface surface{points, Eigen::Matrix3Xi(3, 2), {}};
    surface.triangles << 0, 3, 1, 4, 2, 5;
    return !find_intersections(surface).empty();
  };
  Eigen::Matrix<double, 3, 6> x;
  x << 0, 1, 0, 0.2, 0.2, 0.3, 0, 0, 1, 0.2, 0.3, 0.2, 0, 0, 0, -1, 1, 1;
  EXPECT_TRUE(meet(x));  // an edge through the middle
  x.row(2).tail<3>().array() += 2;
  EXPECT_FALSE(meet(x));
  x << 0, 1, 0, 0.2, 0.3, 0.2, 0, 0, 1, 0.2, 0.2, 0.3, 0, 0, 0, 0, 0, 0;
  EXPECT_TRUE(meet(x));  // one within the other, coplanar
  x.row(0).tail<3>().array() += 1;
  EXPECT_FALSE(meet(x));
}

TriangleSurface stl(const std::string& text) {
  std::istringstream stream(text);
  return read_stl(stream, "a.stl");
}
TriangleSurface obj(const std::string& text) {
  std::istringstream stream(text);
  return read_obj(stream, "a.obj");
}

TEST(SurfaceFiles, ComeBackToTheBit) {
  RandomMeshes random(4);
  for (int i = 0; i < 50; ++i) {
    const TriangleSurface surface = boundary_of(random.make());
    std::ostringstream as_obj, as_stl;
    write_obj(surface, as_obj);
    const TriangleSurface first = obj(as_obj.str());
    ASSERT_EQ(first.points, surface.points);
    ASSERT_EQ(first.triangles, surface.triangles);
    write_stl(surface, as_stl);
    const TriangleSurface second = stl(as_stl.str());  // numbered in the order of corners
    ASSERT_EQ(second.point_count(), surface.point_count());
    for (int t = 0; t < surface.triangle_count(); ++t) {
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(second.points.col(second.triangles(c, t)),
                  surface.points.col(surface.triangles(c, t)));
    }
  }
}

TEST(SurfaceFiles, BinaryStlIsRecognisedByItsLength) {
  std::string bytes = "solid but binary";
  bytes.resize(84, ' ');
  const std::uint32_t count = 2;
  std::memcpy(&bytes[80], &count, 4);
  const float corners[2][12] = {{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0},
                                {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 0}};
  for (const auto& facet : corners) {
    bytes.append(reinterpret_cast<const char*>(facet), sizeof facet);
    bytes.append(2, '\0');
  }
  const TriangleSurface surface = stl(bytes);
  EXPECT_EQ(surface.triangle_count(), 2);
  EXPECT_EQ(surface.point_count(), 4);
}

TEST(SurfaceFiles, ObjTakesFacesOfAnyKind) {
  const TriangleSurface surface = obj(
      "v 0 0 0\nv 1 0 0 # x\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -4 -1/2/3 9\n");
  ASSERT_EQ(surface.triangle_count(), 3);
  EXPECT_EQ(surface.triangles.col(1), Eigen::Vector3i(0, 2, 3));
  EXPECT_EQ(surface.triangles.col(2), Eigen::Vector3i(0, 3, -1));
  EXPECT_EQ(surface.numbers, (std::vector<long>{1, 1, 2}));
}

TEST(SurfaceFiles, ErrorsNameFileAndLine) {
  const auto error_of = [](auto read, const std::string& text) -> std::string {
    try {
      read(text);
    } catch (const ParseError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of(stl, "solid\nfacet\nouter loop\nvertex 1 2\n"), HasSubstr("a.stl:4: "));
  EXPECT_THAT(error_of(stl, "solid\nfacet\nvertex 1 2 3\nendfacet\n"), HasSubstr("1 vertices"));
  EXPECT_THAT(error_of(stl, "solid\nendsolid\n"), HasSubstr("no triangles"));
  EXPECT_THAT(error_of(stl, "ply\n"), HasSubstr("no STL"));
  EXPECT_THAT(error_of(obj, "v 1 2 x\n"), HasSubstr("a.obj:1: 'x' is not a number"));
  EXPECT_THAT(error_of(obj, "v 1 2 3\nf 1 0 1\n"), HasSubstr("a.obj:2: "));
  EXPECT_THAT(error_of(obj, "f 1 a 1\n"), HasSubstr("'a' is no vertex"));
  EXPECT_THAT(error_of(obj, "v 1 2 3\n"), HasSubstr("no faces"));
}

}  // namespace
}  // namespace palpate::mesh
