#include "rt/config/mesh_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/mesh/report.hpp"
#include "core/mesh/surface.hpp"
#include "rt/config/node.hpp"
#include "tests/support/recordings.hpp"

namespace palpate::config {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string mesh_error_of(const std::string& path) {
  try {
    load_mesh(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

class MeshFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("palpate_mesh_file_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path) << text;
    return path;
  }

  std::filesystem::path folder_;
};

TEST_F(MeshFile, ThePairAndWhatIncludesItGiveTheSameMeshTurnedRight) {
  write("one.node", "4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
  const std::string ele = write("one.ele", "1 4\n1 1 3 2 4\n");  // inverted
  const std::string veg =
      write("one.veg", "*VERTICES\n*INCLUDE one.node\n*ELEMENTS\nTETS\n*INCLUDE one.ele\n");
  const mesh::TetrahedralMesh mesh = load_mesh(ele);
  EXPECT_NEAR(mesh::volume(mesh, 0), 1.0 / 6, 1e-16);
  EXPECT_EQ(mesh::hash(mesh), mesh::hash(load_mesh((folder_ / "one.node").string())));
  EXPECT_EQ(mesh::hash(mesh), mesh::hash(load_mesh(veg)));
}

TEST_F(MeshFile, ErrorsNameFileAndLine) {
  EXPECT_THAT(mesh_error_of((folder_ / "none.msh").string()),
              HasSubstr("none.msh: cannot be read"));
  EXPECT_THAT(mesh_error_of(write("a.stl", "")), HasSubstr(".node, .ele, .msh, .veg"));
  const std::string node = write("b.node", "1 3\n1 0 0\n");
  EXPECT_THAT(mesh_error_of(node), HasSubstr("b.ele: cannot be read"));
  write("b.ele", "0 4\n");
  EXPECT_THAT(mesh_error_of(node), StartsWith(node + ":2: "));
  const std::string veg = write("c.veg", "*VERTICES\n*INCLUDE none.node\n");
  EXPECT_THAT(mesh_error_of(veg), StartsWith(veg + ":2: "));
}

struct ThesisMesh {
  const char* name;
  Eigen::Vector3d size;  // m
  int nodes, tetrahedra, triangles, surface_nodes, fixed_nodes;
};

class ThesisMeshes : public ::testing::TestWithParam<ThesisMesh> {};

TEST_P(ThesisMeshes, HaveTheCountsAndVolumeOfTheOriginal) {
  PALPATE_REQUIRE_RECORDING("thesis_meshes");
  const ThesisMesh& expected = GetParam();
  const auto path = support::recordings() / "thesis_meshes" / (std::string(expected.name) + ".ele");
  const mesh::TetrahedralMesh mesh = load_mesh(path.string());
  const mesh::MeshReport report = mesh::check(mesh);
  EXPECT_TRUE(report.ok()) << report.text();
  EXPECT_EQ(mesh.node_count(), expected.nodes);
  EXPECT_EQ(mesh.tetrahedron_count(), expected.tetrahedra);
  EXPECT_NEAR(report.volume, expected.size.prod(), 1e-6 * expected.size.prod());
  EXPECT_TRUE(report.non_manifold_edges.empty());
  const mesh::ElementMesh elements = make_element_mesh(mesh, mesh::ElementOrder::kLinear);
  const mesh::Surface surface = mesh::extract_surface(elements);
  EXPECT_EQ(surface.triangles.cols(), expected.triangles);
  EXPECT_EQ(static_cast<int>(surface.nodes.size()), expected.surface_nodes);
  if (expected.fixed_nodes > 0) {
    const auto fixed = mesh::nodes_in_box(elements, {0, -1, -1}, {0, 1, 1});
    EXPECT_EQ(static_cast<int>(fixed.size()), expected.fixed_nodes);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, ThesisMeshes,
    ::testing::Values(ThesisMesh{"cube", {0.06, 0.06, 0.06}, 153, 486, 240, 122, 29},
                      ThesisMesh{"sponge", {0.08, 0.05, 0.02}, 118, 304, 216, 110, 18},
                      ThesisMesh{"bar", {0.2, 0.04, 0.04}, 152, 385, 274, 139, 19},
                      ThesisMesh{"bar_long", {0.5, 0.06, 0.06}, 207, 536, 372, 188, 12},
                      ThesisMesh{"block", {0.4, 0.06, 0.4}, 360, 1079, 628, 316, 36},
                      ThesisMesh{"example_mesh", {0.3, 0.04, 0.04}, 325, 1306, 384, 194, 0}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(ThesisMeshes, VegaFilesHoldTheSameMeshes) {
  PALPATE_REQUIRE_RECORDING("thesis_meshes");
  const auto folder = support::recordings() / "thesis_meshes";
  const auto hash = [&](const char* name) {
    return mesh::hash(load_mesh((folder / name).string()));
  };
  EXPECT_EQ(hash("bar_soft.veg"), hash("bar.node"));
  EXPECT_EQ(hash("bar_hard.veg"), hash("bar.node"));
  // These two differ in some elements, but neither in the first one nor in their nodes.
  const mesh::TetrahedralMesh zero = load_mesh((folder / "test_mesh_0_indexed.veg").string());
  const mesh::TetrahedralMesh one = load_mesh((folder / "test_mesh_1_indexed.veg").string());
  EXPECT_EQ(zero.nodes, one.nodes);
  EXPECT_EQ(zero.node_count(), 8);
  EXPECT_EQ(zero.tetrahedra.col(0), one.tetrahedra.col(0));
}

class FemCases : public ::testing::TestWithParam<const char*> {};

TEST_P(FemCases, MeshesHaveTheVolumeOfTheirDefinition) {
  PALPATE_REQUIRE_RECORDING("fem_cases");
  const auto folder = support::recordings() / "fem_cases" / GetParam();
  const Node definition = Node::load_file((folder / "case.yaml").string());
  const double volume = definition.child("geometry").number("volume", {0});
  for (const char* name : {"mesh_coarse.msh", "mesh_mid.msh"}) {
    const mesh::MeshWithGroups result = load_mesh_with_groups((folder / name).string());
    const mesh::MeshReport report = mesh::check(result.mesh);
    EXPECT_TRUE(report.ok()) << name << ": " << report.text();
    EXPECT_NEAR(report.volume, volume, 1e-6 * volume) << name;
    ASSERT_EQ(result.groups.count("fixed"), 1u) << name;
    EXPECT_EQ(static_cast<int>(result.groups.at("body").tetrahedra.size()),
              result.mesh.tetrahedron_count());
    // The clamped face is planar and lies at x = 0 in all of these cases.
    const mesh::MeshGroup& fixed = result.groups.at("fixed");
    EXPECT_GT(fixed.triangles.cols(), 0);
    for (const int n : fixed.nodes) EXPECT_NEAR(result.mesh.nodes(0, n), 0, 1e-12);
    const mesh::ElementMesh elements = make_element_mesh(result.mesh, mesh::ElementOrder::kLinear);
    EXPECT_EQ(fixed.nodes, mesh::nodes_in_box(elements, {0, -1, -1}, {0, 1, 1})) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, FemCases,
                         ::testing::Values("bar_tip_1N", "bar_torsion", "beam_nu049", "hetero_bar",
                                           "slender_gravity", "bar_grasp_motion"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace palpate::config
