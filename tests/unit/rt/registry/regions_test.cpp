// Parts of the object by boxes and by groups of the mesh file, and what is said of faults in them.

#include "rt/registry/regions.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "core/elasticity/corotational_model.hpp"
#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/surface.hpp"
#include "rt/registry/object.hpp"
#include "tests/support/refactor.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::registry {
namespace {

constexpr double kLength = 0.4, kSide = 0.1;  // m

/// A bar along x whose file names its ends by triangles, one of them, and its half at x = 0, by
/// tetrahedra.
class Regions : public ::testing::Test {
 protected:
  void SetUp() override {
    mesh::MeshWithGroups bar;
    bar.mesh = mesh::make_grid(
        mesh::even_planes(Eigen::Vector3d::Zero(), {kLength, kSide, kSide}, {8, 2, 2}),
        mesh::CellCut::kSix);
    bar.number_from(1);
    const auto is_at = [&](int node, double x) { return bar.mesh.nodes(0, node) == x; };
    const mesh::Surface surface =
        mesh::extract_surface(mesh::make_element_mesh(bar.mesh, mesh::ElementOrder::kLinear));
    for (const auto& [name, x] : {std::pair("clamp", 0.0), std::pair("gripper", kLength)}) {
      std::vector<int> chosen;
      for (int t = 0; t < surface.triangles.cols(); ++t)
        if (is_at(surface.triangles(0, t), x) && is_at(surface.triangles(1, t), x) &&
            is_at(surface.triangles(2, t), x))
          chosen.push_back(t);
      bar.groups[name].triangles = surface.triangles(Eigen::all, chosen);
    }
    for (int t = 0; t < bar.mesh.tetrahedron_count(); ++t) {
      double x = 0;
      for (int i = 0; i < 4; ++i) x += 0.25 * bar.mesh.nodes(0, bar.mesh.tetrahedra(i, t));
      if (x < kLength / 2) bar.groups["hard half"].tetrahedra.push_back(t);
      if (x > 0.9 * kLength) bar.groups["end"].tetrahedra.push_back(t);
    }
    std::ofstream out(file_, std::ios::binary);
    mesh::write_gmsh(bar, {}, out);
  }

  Object read(const std::string& parts, const std::string& regions = "[]",
              const std::string& order = "quadratic") const {
    const config::Node root = config::Node::from_text(
        "object:\n  mesh: {file: " + file_.string() + "}\n  order: " + order +
            "\n  gravity: false\n  material: {young_modulus: 30e3, poisson_ratio: 0, density: 26, "
            "regions: " +
            regions + "}\n" + parts,
        "bar.yaml");
    Object object = read_object(root, Frames());
    root.check_all_used();
    return object;
  }
  std::string failure(const std::string& parts, const std::string& regions = "[]") const {
    try {
      read(parts, regions);
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  }

  const support::ScratchFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "bar.msh";
};

constexpr const char* kBoxes =
    "  fixed_box: {lower: [0, 0, 0], upper: [0, 1, 1]}\n"
    "  grasp_box: {lower: [0.4, 0, 0], upper: [0.4, 1, 1]}\n";
constexpr const char* kGroups = "  fixed_group: clamp\n  grasp_group: gripper\n";

TEST_F(Regions, AGroupHoldsTheNodesOfTheSameBoxWithThoseBetweenCorners) {
  for (const char* order : {"linear", "quadratic"}) {
    const Object by_box = read(kBoxes, "[]", order), by_group = read(kGroups, "[]", order);
    ASSERT_FALSE(by_box.body.fixed_nodes.empty());
    EXPECT_EQ(by_group.body.fixed_nodes, by_box.body.fixed_nodes) << order;
    ASSERT_EQ(by_group.body.grasps.size(), 1u);
    EXPECT_EQ(by_group.body.grasps[0].nodes, by_box.body.grasps[0].nodes) << order;
    EXPECT_TRUE(by_group.body.grasps[0].X_OG_rest.isApprox(by_box.body.grasps[0].X_OG_rest));
    // A group of tetrahedra holds all of their nodes: the last layer of cells.
    EXPECT_EQ(read("  fixed_group: end\n", "[]", order).body.fixed_nodes,
              read("  fixed_box: {lower: [0.349, 0, 0], upper: [1, 1, 1]}\n", "[]", order)
                  .body.fixed_nodes)
        << order;
  }
}

TEST_F(Regions, StiffnessByRegionIsThatOfSpringsInSeries) {
  constexpr double kSoft = 30e3, kFactor = 3, kPull = 2e-3;
  for (const char* region :
       {"{group: hard half, young_modulus: 90e3}", "{group: hard half, factor: 3}",
        "{box: {lower: [0, 0, 0], upper: [0.2, 1, 1]}, young_modulus: 90e3}"}) {
    const Object object = read(kGroups, std::string("[") + region + "]");
    elasticity::CorotationalQuasistatic model(object.body);
    model.prepare();
    math::Pose X_OG = object.body.grasps[0].X_OG_rest;
    X_OG.translation().x() += kPull;
    model.hold(0, X_OG);
    for (int i = 0; i < 50; ++i) {
      support::refactor(model);
      model.step(1e-3);
    }
    // Without lateral contraction each half is uniformly stretched.
    const double compliance = 0.5 * kLength / (kSide * kSide * kSoft) * (1 + 1 / kFactor);
    EXPECT_NEAR(model.reaction(0).force.x(), kPull / compliance, 2e-3 * kPull / compliance)
        << region;
  }
}

TEST_F(Regions, TheLastRegionCountsWhereTheyOverlap) {
  const Object object = read(kBoxes,
                             "[{group: hard half, young_modulus: 90e3}, {box: {lower: [0.1, 0, 0], "
                             "upper: [1, 1, 1]}, young_modulus: 10e3}]");
  const mesh::ElementMesh& mesh = object.body.mesh;
  for (int e = 0; e < mesh.element_count(); ++e) {
    double x = 0;
    for (int i = 0; i < 4; ++i) x += 0.25 * mesh.nodes(0, mesh.elements(i, e));
    EXPECT_EQ(object.body.material_of(e).young_modulus, x > 0.1 ? 10e3 : 90e3) << x;
    EXPECT_EQ(object.body.material_of(e).density, 26);
  }
}

TEST_F(Regions, FaultsAreReportedWithTheirKey) {
  const auto says = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << part << " in " << message;
  };
  std::string message = failure("  fixed_group: clamps\n");
  says(message, "object.fixed_group");
  says(message, "no group 'clamps'; allowed: clamp, end, gripper, hard half");
  message = failure(std::string(kBoxes) + "  grasp_group: gripper\n");
  says(message, "object.grasp_group");
  says(message, "is given as well as grasp_box");
  message = failure(kBoxes, "[{group: gripper, young_modulus: 90e3}]");
  says(message, "object.material.regions.0.group");
  says(message, "holds no tetrahedra; allowed: end, hard half");
  says(failure(kBoxes, "[{box: {lower: [9, 9, 9], upper: [10, 10, 10]}, factor: 2}]"),
       "holds no element of the mesh");
  message = failure(kBoxes, "[{young_modulus: 90e3}]");
  says(message, "exactly one of box and group");
  message = failure(kBoxes, "[{group: end, young_modulus: 0}]");
  says(message, "object.material.regions.0.young_modulus");
  says(failure(kBoxes, "[{group: end, young_modulus: 1e3, factor: 2}]"),
       "exactly one of young_modulus and factor");
  says(failure("  second_grasp_group: gripper\n"), "needs a grasp_box or grasp_group as well");
  says(failure("  fixed_group: ends\n"), "allowed: clamp, end, gripper, hard half");
}

TEST_F(Regions, APlaceThatIsHeldTwiceIsNamed) {
  // The last layer of cells holds the far end: 2 x 2 cells have 9 corners and 16 midside nodes.
  const std::string message = failure("  fixed_group: end\n  grasp_group: gripper\n");
  EXPECT_NE(message.find("object.grasp_group: 25 of its 25 nodes are held twice: they belong to "
                         "fixed_group as well"),
            std::string::npos)
      << message;
  const std::string boxes = failure(
      "  fixed_box: {lower: [0, 0, 0], upper: [0.1, 1, 1]}\n"
      "  grasp_box: {lower: [0.1, 0, 0], upper: [0.4, 1, 1]}\n");
  EXPECT_NE(boxes.find("object.grasp_box: 25 of its"), std::string::npos) << boxes;
  EXPECT_NE(boxes.find("they belong to fixed_box as well"), std::string::npos) << boxes;
}

}  // namespace
}  // namespace palpate::registry
