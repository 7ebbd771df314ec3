// Each kind of defect, inserted into random valid meshes at random locations: found each time, and
// nothing is reported for valid ones.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <limits>
#include <set>

#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/surface.hpp"
#include "tests/unit/core/mesh/random_meshes.hpp"

namespace palpate::mesh {
namespace {

constexpr int kDamagedMeshes = 1000;

TEST(MeshDefects, NothingIsSaidOfGoodMeshes) {
  RandomMeshes random(1);
  for (int i = 0; i < kDamagedMeshes; ++i) {
    const MeshReport report = check(random.make());
    ASSERT_TRUE(report.ok()) << "mesh " << i << ": " << report.text();
    ASSERT_EQ(report.non_manifold_edges.size() + report.non_manifold_nodes.size(), 0U)
        << "mesh " << i;
  }
}

using Damage = std::function<void(TetrahedralMesh&, RandomMeshes&)>;
using Sees = std::function<bool(const MeshReport&)>;

void expect_found(const Damage& damage, const Sees& sees, bool refused = true) {
  RandomMeshes random(2);
  int found = 0;
  for (int i = 0; i < kDamagedMeshes; ++i) {
    TetrahedralMesh mesh = random.make();
    damage(mesh, random);
    const MeshReport report = check(mesh);
    found += sees(report) && report.ok() != refused ? 1 : 0;
  }
  EXPECT_EQ(found, kDamagedMeshes);
}

int append_node(TetrahedralMesh& mesh, const Eigen::Vector3d& place) {
  mesh.nodes.conservativeResize(3, mesh.node_count() + 1);
  mesh.nodes.rightCols<1>() = place;
  return mesh.node_count() - 1;
}

void append_tetrahedron(TetrahedralMesh& mesh, const Eigen::Vector4i& corners) {
  mesh.tetrahedra.conservativeResize(4, mesh.tetrahedron_count() + 1);
  mesh.tetrahedra.rightCols<1>() = corners;
}

/// One additional tetrahedron, outside the mesh except for its first corners, which it shares.
void add_outside(TetrahedralMesh& mesh, const std::vector<int>& shared) {
  const Eigen::Vector3d lower = mesh.nodes.rowwise().minCoeff(),
                        size = mesh.nodes.rowwise().maxCoeff() - lower;
  Eigen::Vector4i corners;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d away =
        (Eigen::Vector3d(2, 2, 2) + Eigen::Vector3d::Unit(i % 3) * (1 + i)).cwiseProduct(size);
    corners[i] = i < static_cast<int>(shared.size()) ? shared[i] : append_node(mesh, lower + away);
  }
  append_tetrahedron(mesh, corners);
  orient(mesh);
}

TEST(MeshDefects, BadIndex) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes& random) {
        const int bad[] = {-1, mesh.node_count(), std::numeric_limits<int>::max(),
                           std::numeric_limits<int>::min()};
        mesh.tetrahedra(random.below(4), random.below(mesh.tetrahedron_count())) =
            bad[random.below(4)];
      },
      [](const MeshReport& report) { return report.index_out_of_range.size() == 1; });
}

TEST(MeshDefects, NotFinite) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes& random) {
        const double infinite = std::numeric_limits<double>::infinity();
        const double bad[] = {infinite, -infinite, std::numeric_limits<double>::quiet_NaN()};
        mesh.nodes(random.below(3), random.below(mesh.node_count())) = bad[random.below(3)];
      },
      [](const MeshReport& report) { return report.not_finite.size() == 1; });
}

TEST(MeshDefects, TooLargeForNumbers) {
  for (const double scale : {1e110, 1e160, 1e300}) {
    expect_found([scale](TetrahedralMesh& mesh, RandomMeshes&) { mesh.nodes *= scale * 10; },
                 [](const MeshReport& report) { return !report.zero_volume.empty(); });
  }
}

TEST(MeshDefects, ZeroVolume) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes& random) {
        // One corner moves onto the plane, an edge, or a corner of the other three.
        const int t = random.below(mesh.tetrahedron_count());
        Eigen::Vector3d share(random.between(0, 1), random.between(0, 1), random.between(0, 1));
        for (int i = random.below(3); i > 0; --i) share[i] = 0;
        share /= share.sum();
        Eigen::Matrix3d others;
        for (int i = 0; i < 3; ++i) others.col(i) = mesh.nodes.col(mesh.tetrahedra(i + 1, t));
        mesh.nodes.col(mesh.tetrahedra(0, t)) = others * share;
      },
      [](const MeshReport& report) { return !report.zero_volume.empty(); });
}

TEST(MeshDefects, Flipped) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes& random) {
        auto corners = mesh.tetrahedra.col(random.below(mesh.tetrahedron_count()));
        const int a = random.below(4);
        std::swap(corners[a], corners[(a + 1 + random.below(3)) % 4]);
      },
      [](const MeshReport& report) { return report.negative_volume.size() == 1; });
}

TEST(MeshDefects, DuplicateNode) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes& random) {
        // The faces of one tetrahedron are separated, as if two meshes were placed next to each
        // other.
        const double size =
            (mesh.nodes.rowwise().maxCoeff() - mesh.nodes.rowwise().minCoeff()).norm();
        int& corner = mesh.tetrahedra(random.below(4), random.below(mesh.tetrahedron_count()));
        const Eigen::Vector3d apart =
            Eigen::Vector3d::Constant(random.between(-1, 1) * 0.5e-9 * size);
        corner = append_node(mesh, mesh.nodes.col(corner) + apart);
      },
      [](const MeshReport& report) { return !report.duplicate_nodes.empty(); });
}

TEST(MeshDefects, UnusedNode) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes&) {
        append_node(mesh, mesh.nodes.rowwise().maxCoeff() * 2 + Eigen::Vector3d::Ones());
      },
      [](const MeshReport& report) { return report.unused_nodes.size() == 1; });
}

TEST(MeshDefects, Disconnected) {
  expect_found([](TetrahedralMesh& mesh, RandomMeshes&) { add_outside(mesh, {}); },
               [](const MeshReport& report) { return report.parts == 2; });
}

TEST(MeshDefects, HingedAtANode) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes&) {
        int first = 0;  // a corner of the hull
        mesh.nodes.row(0).maxCoeff(&first);
        add_outside(mesh, {first});
      },
      [](const MeshReport& report) {
        return report.parts == 1 && report.non_manifold_nodes.size() == 1;
      },
      false);
}

TEST(MeshDefects, HingedAtAnEdge) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes&) {
        const Surface surface = extract_surface(make_element_mesh(mesh, ElementOrder::kLinear));
        add_outside(mesh, {surface.triangles(0, 0), surface.triangles(1, 0)});
      },
      [](const MeshReport& report) {
        return report.parts == 1 && report.non_manifold_edges.size() == 1;
      },
      false);
}

TEST(MeshDefects, TheSameTetrahedronTwice) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes& random) {
        const Eigen::Vector4i again = mesh.tetrahedra.col(random.below(mesh.tetrahedron_count()));
        append_tetrahedron(mesh, {again[1], again[2], again[0], again[3]});
      },
      [](const MeshReport& report) { return report.overlapping.size() >= 2; });
}

TEST(MeshDefects, AFaceOfThreeTetrahedra) {
  expect_found(
      [](TetrahedralMesh& mesh, RandomMeshes& random) {
        const Surface surface = extract_surface(make_element_mesh(mesh, ElementOrder::kLinear));
        std::set<std::set<int>> outside;
        for (const auto& triangle : surface.triangle_nodes)
          outside.insert({triangle.begin(), triangle.end()});
        Eigen::Vector4i at;
        do {
          at = mesh.tetrahedra.col(random.below(mesh.tetrahedron_count()));
          std::swap(at[3], at[random.below(4)]);
        } while (outside.count({at[0], at[1], at[2]}) > 0);
        add_outside(mesh, {at[0], at[1], at[2]});
      },
      [](const MeshReport& report) { return !report.overlapping.empty(); });
}

TEST(MeshDefects, ThirtyThousandNodesAreLookedAtInTheTimeOfASort) {
  // Planes of a thousand nodes at the same place of each axis, and as many on one point.
  TetrahedralMesh mesh = make_box({1, 1, 1}, {30, 30, 30});
  EXPECT_TRUE(check(mesh).ok());
  const int count = mesh.node_count();
  mesh.nodes.conservativeResize(3, 2 * count);
  mesh.nodes.rightCols(count).colwise() = Eigen::Vector3d(0.5, 0.123, 0.7);
  EXPECT_EQ(check(mesh).duplicate_nodes.size(), static_cast<std::size_t>(count - 1));
}

}  // namespace
}  // namespace palpate::mesh
