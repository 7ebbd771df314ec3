// Meshes within a number of nodes, and triangles with faults by an external program.

#include <gmock/gmock.h>

#include <filesystem>

#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/report.hpp"
#include "tests/unit/tools/mesh/mesh_folder.hpp"
#include "tools/mesh/filling.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

mesh::MeshWithGroups cube_of(double edge) {
  const int cells = std::max(1, static_cast<int>(std::lround(1 / edge)));
  return {mesh::make_box({1, 1, 1}, {cells, cells, cells}), {}, {}};
}

TEST(Budget, QuadraticNodesOfACubeAreThoseOfAGridOfHalfTheCells) {
  EXPECT_EQ(quadratic_node_count(cube_of(1).mesh), 27);
  EXPECT_EQ(quadratic_node_count(cube_of(0.25).mesh), 729);
}

TEST(Budget, IsKeptWhereverTheSearchBegins) {
  for (const double first : {0.02, 0.1, 1.0}) {
    const BudgetedMesh found = fill_within_budget(first, 1000, cube_of);
    // (2 n + 1)^3 with n = 4; the next one is 1331.
    EXPECT_EQ(quadratic_node_count(found.mesh.mesh), 729) << first;
    EXPECT_EQ(std::lround(1 / found.edge), 4);
  }
}

TEST(Budget, OfMeshesWithEnoughNodesTheBestIsTaken) {
  int trials = 0;
  const BudgetedMesh found = fill_within_budget(0.25, 800, [&](double edge) {
    mesh::MeshWithGroups made = cube_of(edge);
    // All are poor, the third one less so.
    made.mesh.nodes.row(2) *= ++trials == 3 ? 0.06 : 0.02;
    return made;
  });
  EXPECT_GT(trials, 3);
  EXPECT_NEAR(mesh::check(found.mesh.mesh).volume, 0.06, 1e-9);
}

TEST(Budget, ThatCannotBeKeptIsReportedWithTheSmallestMesh) {
  try {
    fill_within_budget(0.1, 20, cube_of);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("at most 20"), HasSubstr("smallest has 27")));
  }
}

TEST(Budget, ErrorsOfAllTrialsAreReportedAndThoseOfTheProgramAtOnce) {
  int trials = 0;
  const auto fail = [&](const std::string& why) {
    try {
      trials = 0;
      fill_within_budget(0.1, 100, [&](double) -> mesh::MeshWithGroups {
        ++trials;
        throw std::runtime_error(why);
      });
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), why);
    }
    return trials;
  };
  EXPECT_GT(fail("no tetrahedra"), 3);
  EXPECT_EQ(fail("gmsh is not installed"), 1);
}

class Scan : public MeshFolder {
 protected:
  std::string script(const std::string& text) const {
    const std::string name = write("fake", "#!/bin/sh\n" + text);
    std::filesystem::permissions(name, std::filesystem::perms::owner_all);
    return name;
  }
};

TEST_F(Scan, TrianglesWithFaultsGoToFtetwildAndItsMeshIsChecked) {
  ASSERT_EQ(run({"box", path("a.stl"), "--size", "0.1", "0.1", "0.1", "--edge", "0.05"}), 0);
  mesh::TriangleSurface dirty = read_surface(path("a.stl"), 1);
  dirty.triangles = dirty.triangles.rightCols(dirty.triangle_count() - 5).eval();
  write_surface(dirty, path("dirty.stl"));
  ASSERT_EQ(run({"box", path("made.msh"), "--size", "0.1", "0.1", "0.1", "--edge", "0.025", "--msh",
                 "2.2", "--binary"}),
            0);
  // Stands in for the program: keeps its arguments, and answers with a mesh of the form it writes.
  const std::string program =
      script("echo \"$@\" > " + path("arguments") + "\ncp \"$2\" " + path("received.stl") +
             "\ncp " + path("made.msh") + " \"$4\"\n");
  const nlohmann::json result =
      run_json({"scan", path("dirty.stl"), path("b.msh"), "--ftetwild", program, "--nodes", "800"});
  EXPECT_EQ(result["quality"]["nodes"], 125);
  EXPECT_NEAR(result["quality"]["volume_m3"], 1e-3, 1e-9);
  EXPECT_THAT(text_of("arguments"), AllOf(HasSubstr("--la 0.0"), HasSubstr("--epsr 0.001"),
                                          HasSubstr("--manifold-surface")));
  EXPECT_EQ(read_surface(path("received.stl"), 1).triangle_count(), dirty.triangle_count());
  EXPECT_EQ(
      run({"scan", path("dirty.stl"), path("c.msh"), "--ftetwild", program, "--nodes", "500"}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("at most 500"), HasSubstr("729")));
}

TEST_F(Scan, ReportsThatFtetwildIsMissingSlowOrFailing) {
  ASSERT_EQ(run({"box", path("a.stl"), "--size", "0.1", "0.1", "0.1", "--edge", "0.05"}), 0);
  const auto scan = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"scan", path("a.stl"), path("b.msh")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  EXPECT_EQ(scan({"--ftetwild", "FloatTetwild-of-another-name"}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("is not installed"), HasSubstr("wildmeshing/fTetWild")));
  EXPECT_EQ(scan({"--ftetwild", script("sleep 100"), "--time-limit", "0.3"}), 1);
  EXPECT_THAT(output(), HasSubstr("did not end within 0.3 s"));
  EXPECT_EQ(scan({"--ftetwild", script("echo 'no winding'; exit 3")}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("exit code 3"), HasSubstr("no winding")));
  EXPECT_FALSE(std::filesystem::exists(path("b.msh")));
}

TEST_F(Scan, WrongCommandsAndCloudsAreReported) {
  EXPECT_EQ(run({"scan", path("a.xyz"), path("b.msh"), "--nodes", "3001"}), 64);
  EXPECT_EQ(run({"scan", path("a.xyz"), path("b.msh"), "--nodes", "9"}), 64);
  EXPECT_EQ(run({"scan", path("none.xyz"), path("b.msh")}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("none.xyz"), HasSubstr("No such file")));
  EXPECT_EQ(run({"scan", write("empty.xyz", ""), path("b.msh")}), 1);
  EXPECT_THAT(output(), HasSubstr("empty.xyz"));
  std::string few;
  for (int i = 0; i < 50; ++i) few += std::to_string(0.001 * i) + " 0 0\n";
  EXPECT_EQ(run({"scan", write("few.xyz", few), path("b.msh")}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("few.xyz: 50 points"), HasSubstr("200 or more")));
  EXPECT_FALSE(std::filesystem::exists(path("b.msh")));
}

}  // namespace
}  // namespace palpate::mesh_tool
