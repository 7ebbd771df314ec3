// Random valid meshes with one kind of defect at random locations: after a repair they are valid
// again and have their original volume.

#include "core/mesh/repair.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

#include "core/mesh/node_motion.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/surface.hpp"
#include "tests/unit/core/mesh/random_meshes.hpp"

namespace palpate::mesh {
namespace {

constexpr int kMeshes = 60;

using Break = std::function<void(MeshWithGroups&, RandomMeshes&)>;

int add_node(TetrahedralMesh& mesh, const Eigen::Vector3d& p) {
  mesh.nodes.conservativeResize(3, mesh.node_count() + 1);
  mesh.nodes.rightCols<1>() = p;
  return mesh.node_count() - 1;
}

void add_tetrahedron(TetrahedralMesh& mesh, const Eigen::Vector4i& corners) {
  mesh.tetrahedra.conservativeResize(4, mesh.tetrahedron_count() + 1);
  mesh.tetrahedra.rightCols<1>() = corners;
}

/// Inserts a defect, checks that it is found, repairs, and checks that it is gone. `share`:
/// fraction of the meshes that must be repaired; others may be rejected, but never reported as
/// valid.
void expect_repaired(const Break& damage, const std::string& step, double share = 1,
                     const RepairOptions& options = {}) {
  RandomMeshes random(7);
  int repaired = 0;
  for (int i = 0; i < kMeshes; ++i) {
    MeshWithGroups mesh{random.make(), {}, {}};
    const double volume = check(mesh.mesh).volume;
    damage(mesh, random);
    ASSERT_TRUE(!check(mesh.mesh).ok() || !mesh.others.empty()) << i;
    const std::vector<RepairStep> steps = repair(mesh, options);
    const MeshReport report = check(mesh.mesh);
    if (!report.ok()) continue;
    ++repaired;
    ASSERT_NEAR(report.volume, volume, 1e-9 * volume) << i << ": " << report.text();
    bool reported = false;
    for (const RepairStep& each : steps)
      reported = reported || each.what.find(step) != std::string::npos;
    ASSERT_TRUE(reported) << i << ": no report of " << step;
    ASSERT_EQ(mesh.node_numbers.size(), static_cast<std::size_t>(mesh.mesh.node_count()));
    ASSERT_EQ(mesh.tetrahedron_numbers.size(),
              static_cast<std::size_t>(mesh.mesh.tetrahedron_count()));
  }
  EXPECT_GE(repaired, share * kMeshes);
}

TEST(Repair, LeavesGoodMeshesAsTheyAre) {
  RandomMeshes random(1);
  for (int i = 0; i < kMeshes; ++i) {
    MeshWithGroups mesh{random.make(), {}, {}};
    const auto before = hash(mesh.mesh);
    EXPECT_TRUE(repair(mesh, {}).empty());
    ASSERT_EQ(hash(mesh.mesh), before);
  }
}

TEST(Repair, TurnsElements) {
  expect_repaired(
      [](MeshWithGroups& mesh, RandomMeshes& random) {
        for (int k = 1 + random.below(3); k > 0; --k) {
          auto corners = mesh.mesh.tetrahedra.col(random.below(mesh.mesh.tetrahedron_count()));
          std::swap(corners[random.below(3)], corners[3]);
        }
        if (check(mesh.mesh).negative_volume.empty())
          std::swap(mesh.mesh.tetrahedra(0, 0), mesh.mesh.tetrahedra(1, 0));
      },
      "turned");
}

TEST(Repair, TurnsAWholeMeshOfTheOtherConvention) {
  expect_repaired(
      [](MeshWithGroups& mesh, RandomMeshes& random) {
        const int right = random.below(mesh.mesh.tetrahedron_count());
        for (int t = 0; t < mesh.mesh.tetrahedron_count(); ++t) {
          if (t != right) std::swap(mesh.mesh.tetrahedra(0, t), mesh.mesh.tetrahedra(1, t));
        }
      },
      "turned");
}

TEST(Repair, PutsBackAStrayedNode) {
  // A node of a grid fine enough to have some inside, moved across its neighbours.
  RandomMeshes random(3);
  int repaired = 0;
  for (int i = 0; i < 40; ++i) {
    MeshWithGroups mesh{make_box({0.1, 0.1, 0.1}, {3, 3, 3}), {}, {}};
    const double volume = check(mesh.mesh).volume;
    const int n = 21 + random.below(2) + 4 * random.below(2) + 16 * random.below(2);
    mesh.mesh.nodes.col(n) +=
        Eigen::Vector3d(random.between(-0.05, 0.05), random.between(-0.05, 0.05), 0.045);
    const bool was_broken = !check(mesh.mesh).ok();
    const std::vector<RepairStep> steps = repair(mesh, {});
    const MeshReport report = check(mesh.mesh);
    ASSERT_TRUE(report.ok()) << i << ": " << report.text();
    ASSERT_NEAR(report.volume, volume, 1e-12 * volume);
    ASSERT_GT(report.quality_min, 0.01);
    repaired += was_broken && !steps.empty() ? 1 : 0;
  }
  EXPECT_GT(repaired, 20);
}

TEST(Repair, MergesNodes) {
  expect_repaired(
      [](MeshWithGroups& mesh, RandomMeshes& random) {
        for (int k = 0; k < 3; ++k) {
          int& corner =
              mesh.mesh.tetrahedra(random.below(4), random.below(mesh.mesh.tetrahedron_count()));
          corner = add_node(mesh.mesh, mesh.mesh.nodes.col(corner) * (1 + 1e-13));
        }
      },
      "merged");
}

TEST(Repair, DropsStrayNodes) {
  expect_repaired(
      [](MeshWithGroups& mesh, RandomMeshes& random) {
        add_node(mesh.mesh, mesh.mesh.nodes.col(random.below(mesh.mesh.node_count())));
        add_node(mesh.mesh, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
      },
      "in no element");
}

TEST(Repair, DropsRepeatedElements) {
  expect_repaired(
      [](MeshWithGroups& mesh, RandomMeshes& random) {
        const Eigen::Vector4i again =
            mesh.mesh.tetrahedra.col(random.below(mesh.mesh.tetrahedron_count()));
        add_tetrahedron(mesh.mesh, {again[1], again[0], again[2], again[3]});
      },
      "there twice");
}

TEST(Repair, DropsElementsThatNameANodeTwice) {
  expect_repaired(
      [](MeshWithGroups& mesh, RandomMeshes& random) {
        const Eigen::Vector4i c =
            mesh.mesh.tetrahedra.col(random.below(mesh.mesh.tetrahedron_count()));
        add_tetrahedron(mesh.mesh, {c[0], c[1], c[2], c[0]});
      },
      "name a node twice");
}

TEST(Repair, PeelsFlatElementsOffTheSurface) {
  // One side of a box of cells in which neighbours on the surface are coplanar.
  RandomMeshes random(5);
  for (int i = 0; i < 30; ++i) {
    MeshWithGroups mesh{make_box({0.1, 0.1, 0.1}, {2 + random.below(3), 2, 2}), {}, {}};
    const Surface surface = extract_surface(make_element_mesh(mesh.mesh, ElementOrder::kLinear));
    // Two triangles of the surface that share an edge and a plane.
    bool added = false;
    for (int s = random.below(10); s < surface.triangles.cols() && !added; ++s) {
      for (int t = 0; t < surface.triangles.cols() && !added; ++t) {
        std::set<int> corners(surface.triangles.col(s).begin(), surface.triangles.col(s).end());
        corners.insert(surface.triangles.col(t).begin(), surface.triangles.col(t).end());
        if (corners.size() != 4) continue;
        const std::vector<int> c(corners.begin(), corners.end());
        add_tetrahedron(mesh.mesh, {c[0], c[1], c[2], c[3]});
        const int last = mesh.mesh.tetrahedron_count() - 1;
        added = std::abs(volume(mesh.mesh, last)) < 1e-18;
        if (!added) mesh.mesh.tetrahedra.conservativeResize(4, last);
      }
    }
    ASSERT_TRUE(added);
    ASSERT_FALSE(check(mesh.mesh).ok());
    const std::vector<RepairStep> steps = repair(mesh, {});
    EXPECT_TRUE(check(mesh.mesh).ok()) << check(mesh.mesh).text();
    EXPECT_NEAR(check(mesh.mesh).volume, 1e-3, 1e-15);
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_NE(steps[0].what.find("peeled"), std::string::npos);
  }
}

TEST(Repair, GivesFlatElementsVolume) {
  // An inner node moves into the plane of a distant face.
  RandomMeshes random(6);
  for (int i = 0; i < 30; ++i) {
    MeshWithGroups mesh{make_box({0.1, 0.1, 0.1}, {2, 2, 2}), {}, {}};
    for (int t = 0; t < mesh.mesh.tetrahedron_count(); ++t) {
      const auto c = mesh.mesh.tetrahedra.col(t);
      if (c[0] != 13 || random.below(3) != 0) continue;
      mesh.mesh.nodes.col(13) = mesh.mesh.nodes(Eigen::all, c.tail<3>()).rowwise().mean();
      break;
    }
    if (check(mesh.mesh).ok()) continue;
    repair(mesh, {});
    EXPECT_TRUE(check(mesh.mesh).ok()) << check(mesh.mesh).text();
    EXPECT_NEAR(check(mesh.mesh).volume, 1e-3, 1e-15);
  }
}

TEST(Repair, CollapsesAnEdgeOfFlatElementsOnAnEdgeOfTheBody) {
  // An additional node at the middle of an edge of the body splits each tetrahedron at that edge
  // into two; flat ones result from pulling a fan onto the edge.
  TetrahedralMesh one;
  one.nodes.resize(3, 5);
  one.nodes << 0, 1, 0, 0, 0.5, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0;
  // (4) lies on the edge 01; the tetrahedron 0 4 1 2 is flat, the valid ones are attached to it.
  one.tetrahedra.resize(4, 2);
  one.tetrahedra.col(0) << 0, 1, 2, 3;
  one.tetrahedra.col(1) << 0, 4, 1, 2;
  MeshWithGroups mesh{one, {}, {}};
  ASSERT_EQ(check(mesh.mesh).zero_volume.size(), 1u);
  repair(mesh, {});
  EXPECT_TRUE(check(mesh.mesh).ok()) << check(mesh.mesh).text();
  EXPECT_NEAR(check(mesh.mesh).volume, 1.0 / 6, 1e-15);
}

TEST(Repair, DropsSmallPartsOnlyWhereAsked) {
  const auto add_part = [](MeshWithGroups& mesh, RandomMeshes&) {
    const double size =
        0.01 * (mesh.mesh.nodes.rowwise().maxCoeff() - mesh.mesh.nodes.rowwise().minCoeff()).norm();
    const Eigen::Vector3d at =
        1.5 * mesh.mesh.nodes.rowwise().maxCoeff().cwiseAbs() + Eigen::Vector3d::Constant(size);
    const int a = add_node(mesh.mesh, at),
              b = add_node(mesh.mesh, at + size * Eigen::Vector3d::UnitX());
    const int c = add_node(mesh.mesh, at + size * Eigen::Vector3d::UnitY());
    const int d = add_node(mesh.mesh, at + size * Eigen::Vector3d::UnitZ());
    add_tetrahedron(mesh.mesh, {a, b, c, d});
  };
  RepairOptions largest;
  largest.parts = Parts::kKeepLargest;
  expect_repaired(add_part, "largest part", 1, largest);
  RandomMeshes random(1);
  MeshWithGroups mesh{random.make(), {}, {}};
  add_part(mesh, random);
  repair(mesh, {});
  EXPECT_EQ(check(mesh.mesh).parts, 2);
}

TEST(Repair, LeavesWhatItCannotRepair) {
  RandomMeshes random(1);
  const TetrahedralMesh good = random.make();
  MeshWithGroups lost{good, {}, {}}, nowhere{good, {}, {}}, overlap{good, {}, {}};
  lost.mesh.tetrahedra(2, 3) = -1;
  repair(lost, {});
  EXPECT_EQ(check(lost.mesh).index_out_of_range.size(), 1u);
  nowhere.mesh.nodes(1, nowhere.mesh.tetrahedra(0, 0)) = INFINITY;
  repair(nowhere, {});
  EXPECT_EQ(check(nowhere.mesh).not_finite.size(), 1u);
  const Eigen::Vector4i c = overlap.mesh.tetrahedra.col(0);
  const Eigen::Vector3d middle = good.nodes(Eigen::all, c).rowwise().mean();
  add_tetrahedron(overlap.mesh, {c[0], c[1], c[2], add_node(overlap.mesh, middle)});
  repair(overlap, {});
  EXPECT_FALSE(check(overlap.mesh).overlapping.empty());
}

TEST(Repair, GroupsFollow) {
  MeshWithGroups mesh{make_box({1, 1, 1}, {2, 1, 1}), {}, {}};
  mesh.groups["left"].tetrahedra = {0, 1, 2, 3, 4, 5};
  mesh.groups["right"].tetrahedra = {6, 7, 8, 9, 10, 11};
  add_node(mesh.mesh, {0.5, 0.5, 9});
  const Eigen::Vector4i again = mesh.mesh.tetrahedra.col(2);
  add_tetrahedron(mesh.mesh, again);
  mesh.groups["right"].tetrahedra.push_back(12);  // the copy is in another group
  repair(mesh, {});
  EXPECT_EQ(mesh.groups["left"].tetrahedra, (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(mesh.groups["right"].tetrahedra, (std::vector<int>{2, 6, 7, 8, 9, 10, 11}));
}

TEST(CellSplit, NeighboursOfAnyKindMatch) {
  // A grid of hexahedra, some divided into two prisms and some into pyramids about their centre,
  // with randomly numbered nodes.
  RandomMeshes random(4);
  for (int round = 0; round < 50; ++round) {
    const std::array<int, 3> cells{1 + random.below(3), 1 + random.below(3), 1 + random.below(3)};
    MeshWithGroups mesh;
    const int count = (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
    std::vector<int> number(count);
    for (int n = 0; n < count; ++n) number[n] = n;
    for (int n = count - 1; n > 0; --n) std::swap(number[n], number[random.below(n + 1)]);
    mesh.mesh.nodes.resize(3, count);
    const auto node = [&](int i, int j, int k) {
      const int n = number[i + (cells[0] + 1) * (j + (cells[1] + 1) * k)];
      mesh.mesh.nodes.col(n) << i, j, k;
      return n;
    };
    for (int k = 0; k < cells[2]; ++k) {
      for (int j = 0; j < cells[1]; ++j) {
        for (int i = 0; i < cells[0]; ++i) {
          const std::array<int, 8> c{node(i, j, k),
                                     node(i + 1, j, k),
                                     node(i + 1, j + 1, k),
                                     node(i, j + 1, k),
                                     node(i, j, k + 1),
                                     node(i + 1, j, k + 1),
                                     node(i + 1, j + 1, k + 1),
                                     node(i, j + 1, k + 1)};
          mesh.others.push_back({8, c, 1});
        }
      }
    }
    // The last cell as two prisms: only if no neighbour shares the divided face.
    if (cells[2] == 1) {
      const std::array<int, 8> c = mesh.others.back().corners;
      mesh.others.pop_back();
      mesh.others.push_back({6, {c[0], c[1], c[2], c[4], c[5], c[6]}, 2});
      mesh.others.push_back({6, {c[0], c[2], c[3], c[4], c[6], c[7]}, 3});
    }
    split_cells(mesh);
    const MeshReport report = check(mesh.mesh);
    ASSERT_TRUE(report.ok()) << report.text();
    ASSERT_TRUE(report.non_manifold_edges.empty());
    ASSERT_NEAR(report.volume, cells[0] * cells[1] * cells[2], 1e-12);
    // Closed: two surface triangles for each outer square.
    const Surface surface = extract_surface(make_element_mesh(mesh.mesh, ElementOrder::kLinear));
    ASSERT_EQ(surface.triangles.cols(),
              4 * (cells[0] * cells[1] + cells[1] * cells[2] + cells[2] * cells[0]));
  }
}

TEST(NodeMotion, BettersTheWorstAndKeepsTheShape) {
  RandomMeshes random(9);
  for (int i = 0; i < 20; ++i) {
    MeshWithGroups mesh{make_box({0.1, 0.06, 0.06}, {5, 3, 3}), {}, {}};
    const MeshReport whole = check(mesh.mesh);
    for (int n = 0; n < mesh.mesh.node_count(); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        double& x = mesh.mesh.nodes(axis, n);
        const double most = axis == 0 ? 0.1 : 0.06;
        if (x > 1e-9 && x < most - 1e-9) x += random.between(-0.006, 0.006);
      }
    }
    const MeshReport before = check(mesh.mesh);
    ASSERT_TRUE(before.ok());
    EXPECT_GT(move_nodes(mesh), 0);
    const MeshReport after = check(mesh.mesh);
    ASSERT_TRUE(after.ok());
    EXPECT_NEAR(after.volume, whole.volume, 1e-12 * whole.volume);
    EXPECT_GT(after.quality_min, before.quality_min);
    EXPECT_GT(after.quality_mean, before.quality_mean);
    EXPECT_NEAR(mesh.mesh.nodes.minCoeff(), 0, 1e-15);
  }
}

}  // namespace
}  // namespace palpate::mesh
