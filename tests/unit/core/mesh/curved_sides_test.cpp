#include "core/mesh/curved_sides.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 0.02, kLength = 0.1;  // m

/// A box of square section mapped to a cylinder about x: each square ring becomes a circle.
Vector3d on_disc(const Vector3d& p) {
  const double y = p.y() - 1, z = p.z() - 1;  // -1 to 1
  const double ring = std::max(std::abs(y), std::abs(z)), length = std::hypot(y, z);
  if (length == 0) return {p.x() * kLength, 0, 0};
  return {p.x() * kLength, kRadius * ring * y / length, kRadius * ring * z / length};
}

struct Cylinder {
  TetrahedralMesh mesh;
  EdgeMiddles middles;

  explicit Cylinder(int cells) {
    const TetrahedralMesh box = make_box({1, 2, 2}, {2, cells, cells});
    mesh = box;
    for (int i = 0; i < box.node_count(); ++i) mesh.nodes.col(i) = on_disc(box.nodes.col(i));
    orient(mesh);
    // Midpoints of edges along the outer circle lie on it; those inside and on the caps are
    // straight.
    const Surface surface = extract_surface(make_element_mesh(mesh, ElementOrder::kLinear));
    for (int t = 0; t < surface.triangles.cols(); ++t) {
      for (int i = 0; i < 3; ++i) {
        const int a = surface.triangles(i, t), b = surface.triangles((i + 1) % 3, t);
        const auto outside = [&](int node) {
          return mesh.nodes.col(node).tail<2>().norm() > 0.999 * kRadius;
        };
        if (!outside(a) || !outside(b)) continue;
        Vector3d middle = 0.5 * (mesh.nodes.col(a) + mesh.nodes.col(b));
        middle.tail<2>() *= kRadius / middle.tail<2>().norm();
        middles[std::minmax(a, b)] = middle;
      }
    }
  }
};

constexpr double kTrueVolume = M_PI * kRadius * kRadius * kLength;

double straight_volume(const TetrahedralMesh& mesh) {
  double sum = 0;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) sum += volume(mesh, t);
  return sum;
}

TEST(CurvedSides, FlatOnesLeaveABoxAlone) {
  TetrahedralMesh box = make_box({0.3, 0.1, 0.2}, {3, 2, 2});
  const Eigen::Matrix3Xd nodes = box.nodes;
  EdgeMiddles middles;
  for (int t = 0; t < box.tetrahedron_count(); ++t) {
    for (const auto& edge : kTetrahedronEdges) {
      const int a = box.tetrahedra(edge[0], t), b = box.tetrahedra(edge[1], t);
      middles[std::minmax(a, b)] = 0.5 * (box.nodes.col(a) + box.nodes.col(b));
    }
  }
  EXPECT_NEAR(curved_volume(box, middles), 0.3 * 0.1 * 0.2, 1e-15);
  EXPECT_EQ(keep_curved_volume(box, middles), 0);
  EXPECT_EQ(box.nodes, nodes);
}

TEST(CurvedSides, VolumeWithinThemIsThatOfTheBody) {
  const Cylinder coarse(2), fine(6);
  EXPECT_LT(straight_volume(coarse.mesh), 0.92 * kTrueVolume) << "an octagon";
  EXPECT_NEAR(curved_volume(coarse.mesh, coarse.middles), kTrueVolume, 3e-3 * kTrueVolume);
  EXPECT_NEAR(curved_volume(fine.mesh, fine.middles), kTrueVolume, 3e-5 * kTrueVolume);
  EXPECT_NEAR(curved_volume(fine.mesh, {}), straight_volume(fine.mesh), 1e-12 * kTrueVolume);
}

TEST(CurvedSides, StraightOnesTakeTheVolumeOver) {
  for (const int cells : {2, 4}) {
    Cylinder cylinder(cells);
    const TetrahedralMesh before = cylinder.mesh;
    const double wanted = curved_volume(before, cylinder.middles);
    const double moved = keep_curved_volume(cylinder.mesh, cylinder.middles);
    EXPECT_NEAR(straight_volume(cylinder.mesh), wanted, 1e-10 * wanted);
    EXPECT_GT(moved, 1e-3 * kRadius);
    EXPECT_LT(moved, 0.1 * kRadius);
    for (int i = 0; i < before.node_count(); ++i) {
      const Vector3d from = before.nodes.col(i), to = cylinder.mesh.nodes.col(i);
      EXPECT_NEAR(from.x(), to.x(), 1e-12) << "caps stay flat";
      if (from.tail<2>().norm() < 0.999 * kRadius) {
        EXPECT_EQ(from, to) << "inner nodes stay";
        continue;
      }
      const Vector3d along = to - from;
      EXPECT_GT(along.dot(Vector3d(0, from.y(), from.z())), 0) << "outward";
    }
  }
}

// The second moment of area, to which bending stiffness is proportional.
TEST(CurvedSides, BendingStiffnessComesNearTheTrueOne) {
  const auto second_moment = [](const TetrahedralMesh& mesh) {
    double sum = 0;
    for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
      double products = 0;  // integral of z^2 over a tetrahedron: V/20 (sum z_i^2 + (sum z_i)^2)
      double total = 0;
      for (int i = 0; i < 4; ++i) {
        const double z = mesh.nodes(2, mesh.tetrahedra(i, t));
        products += z * z;
        total += z;
      }
      sum += volume(mesh, t) / 20 * (products + total * total);
    }
    return sum;
  };
  const double expected = M_PI / 4 * std::pow(kRadius, 4) * kLength;
  Cylinder cylinder(2);
  const double inscribed = second_moment(cylinder.mesh);
  keep_curved_volume(cylinder.mesh, cylinder.middles);
  EXPECT_LT(inscribed, 0.85 * expected);
  EXPECT_NEAR(second_moment(cylinder.mesh), expected, 0.02 * expected);
}

TEST(CurvedSides, TooCurvedOnesAreRefused) {
  TetrahedralMesh one = make_box({1, 1, 1}, {1, 1, 1});
  const Eigen::Matrix3Xd nodes = one.nodes;
  EdgeMiddles middles;
  const Surface surface = extract_surface(make_element_mesh(one, ElementOrder::kLinear));
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const int a = surface.triangles(i, t), b = surface.triangles((i + 1) % 3, t);
      const Vector3d straight = 0.5 * (one.nodes.col(a) + one.nodes.col(b));
      middles[std::minmax(a, b)] = straight + 3 * (Vector3d(0.5, 0.5, 0.5) - straight);
    }
  }
  EXPECT_THROW(keep_curved_volume(one, middles), std::invalid_argument);
  EXPECT_EQ(one.nodes, nodes);
}

}  // namespace
}  // namespace palpate::mesh
