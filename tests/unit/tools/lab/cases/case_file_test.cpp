#include "tools/lab/cases/case_file.hpp"

#include <gtest/gtest.h>

#include "rt/config/node.hpp"
#include "tests/unit/tools/lab/cases/case_folder.hpp"
#include "tools/lab/cases/case_mesh.hpp"
#include "tools/lab/cases/case_problem.hpp"

namespace palpate::cases {
namespace {

using Eigen::Vector3d;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text.replace(place, from.size(), to);
}

TEST(CaseFile, ReadsWhatAFolderSays) {
  const CaseFolder folder;
  write_pulled_bar(folder);
  folder.write("summary.json", R"({"reference": {"monitored": "mean"}})");
  const CaseFile c = read_case(folder.path() / "");
  EXPECT_EQ(c.name, "pulled_bar");
  ASSERT_EQ(c.boxes.size(), 1u);
  EXPECT_EQ(c.boxes[0].max(), Vector3d(0.2, 0.04, 0.04));
  EXPECT_EQ(c.material.young_modulus, 1e5);
  EXPECT_GT(c.material.density, 0);
  EXPECT_EQ(c.gravity, Vector3d::Zero());  // nothing has weight
  EXPECT_EQ(c.fixed->group, "fixed");
  ASSERT_EQ(c.loads.size(), 1u);
  EXPECT_EQ(*c.loads[0].total_force, Vector3d(2, 0, 0));
  EXPECT_FALSE(c.grasp);
  EXPECT_EQ(c.meshes.count("coarse"), 1u);
  EXPECT_EQ(c.probes.size(), 11u);
  EXPECT_NEAR(c.largest_reference(), kPulledStretch * 0.2, 1e-15);
  EXPECT_EQ(c.summary.at("reference").at("monitored"), "mean");
}

TEST(CaseFile, NeedsLittle) {
  const CaseFolder folder;
  write_pulled_bar(folder, "material: {E: 1e5, nu: 0.3, rho: 26}\nfixed: {group: fixed}\n");
  const CaseFile c = read_case(folder.path());
  EXPECT_EQ(c.name, folder.path().filename().string());
  EXPECT_EQ(c.material.density, 26);
  EXPECT_TRUE(c.boxes.empty() && c.loads.empty() && c.overrides.empty() && c.summary.empty());
  EXPECT_EQ(c.meshes.at("coarse"), folder.path() / "mesh_coarse.msh");
}

TEST(CaseFile, KnowsASingleBoxAndRegionsWithoutOne) {
  const CaseFolder folder;
  write_pulled_bar(folder,
                   "geometry: {type: box, min: [0, 0, 0], max: [0.2, 0.04, 0.04]}\n"
                   "material: {E: 1e5, nu: 0.3}\nfixed: {box: null}\n");
  const CaseFile c = read_case(folder.path());
  ASSERT_EQ(c.boxes.size(), 1u);
  EXPECT_EQ(c.boxes[0].sizes(), Vector3d(0.2, 0.04, 0.04));
  EXPECT_TRUE(c.fixed->box.isEmpty());
}

TEST(CaseFile, KeepsTheWeightOfAPartWhenTheRestHasNone) {
  const CaseFolder folder;
  write_pulled_bar(folder, std::string(kPulledBar) +
                               "material_overrides:\n- box: {min: [0, 0, 0], max: [0.08, 1, 1]}\n"
                               "  E: 2e5\n  rho: 500\n");
  const CaseFile c = read_case(folder.path());
  EXPECT_EQ(c.gravity, Vector3d(0, 0, -9.81));
  EXPECT_EQ(c.overrides.at(0).material.density, 500);
  EXPECT_EQ(c.overrides.at(0).material.poisson_ratio, 0);  // as everywhere
  EXPECT_GT(c.material.density, 0);
  EXPECT_LT(c.material.density, 1e-6);

  const CaseProblem problem =
      make_problem(c, read_case_mesh(c, "coarse"), mesh::ElementOrder::kLinear);
  int stiff = 0;
  for (int e = 0; e < problem.body.mesh.element_count(); ++e)
    stiff += problem.body.material_of(e).young_modulus == 2e5;
  EXPECT_EQ(stiff, 2 * 6);  // two of five cells
}

TEST(CaseFile, ReadsAGrasp) {
  const CaseFolder folder;
  const std::string grasp = R"(
grasp:
  centre: [0.2, 0.02, 0.02]
  translation: [0.01, 0, 0]
  rotation_axis: [0, 0, 2]
  rotation_deg: 90
)";
  write_pulled_bar(folder, kPulledBar + grasp);
  const CaseFile c = read_case(folder.path());
  ASSERT_TRUE(c.grasp);
  EXPECT_EQ(c.grasp->region.group, "grasp");
  const math::Pose moved = c.grasp->X_OG * c.grasp->X_OG_rest.inverse();
  EXPECT_LT((moved * Vector3d(0.2, 0.02, 0.02) - Vector3d(0.21, 0.02, 0.02)).norm(), 1e-15);
  EXPECT_LT((moved * Vector3d(0.2, 0.04, 0.02) - Vector3d(0.19, 0.02, 0.02)).norm(), 1e-15);
}

struct BadCase {
  const char* from;
  const char* to;
  const char* message;  // part of it
};

class BadCases : public testing::TestWithParam<BadCase> {};

TEST_P(BadCases, AreNamedByFileAndKey) {
  const CaseFolder folder;
  write_pulled_bar(folder, replaced(kPulledBar, GetParam().from, GetParam().to));
  try {
    const CaseFile c = read_case(folder.path());
    make_problem(c, read_case_mesh(c, "coarse"), mesh::ElementOrder::kQuadratic);
    FAIL() << "was accepted";
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find(folder.path().string()), std::string::npos)
        << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Edits, BadCases,
    testing::Values(
        BadCase{"E: 100000.0", "E: -1", "material.E"}, BadCase{"E: 100000.0, ", "", "material.E"},
        BadCase{"nu: 0.0", "nu: 0.5", "material.nu"},
        BadCase{"rho: 0.0", "rho: heavy", "material.rho"}, BadCase{"-9.81]", "]", "gravity"},
        BadCase{"follower: false", "follower: true", "loads.0.follower"},
        BadCase{"type: total_force_uniform_traction", "type: pressure", "loads.0.type"},
        BadCase{"total_force: [2.0, 0.0, 0.0]", "note: none", "loads.0.total_force"},
        BadCase{"type: total_force_uniform_traction", "type: traction_field", "loads.0.formula"},
        BadCase{"total_force: [2.0, 0.0, 0.0]\n", "total_force: [2, 0, 0]\ngrasp: {group: load}\n",
                "grasp.centre"},
        BadCase{"type: total_force_uniform_traction\n  total_force: [2.0, 0.0, 0.0]",
                "type: traction_field\n  formula: t = (0, k*z, 0)", "loads.0.k"},
        BadCase{"type: total_force_uniform_traction\n  total_force: [2.0, 0.0, 0.0]",
                "type: traction_field\n  formula: t = (0, z", "loads.0.formula"},
        BadCase{"max: [0, 0.04, 0.04]", "max: [-1, 0.04, 0.04]", "fixed.box.max"},
        BadCase{"- group: load", "- group: top", "loads.0.group"},
        BadCase{"  group: fixed", "  group: clamp", "allowed: fixed, load"},
        BadCase{"files: {mesh_coarse: mesh_coarse.msh}", "files: {mesh_fine: fine.msh}",
                "files.mesh_coarse"},
        BadCase{"mesh_coarse.msh", "probes.csv", "probes.csv"},
        BadCase{"files: {", "files: {probes: none.csv, ", "none.csv"}));

TEST(CaseFile, RefusesARotationThatIsNone) {
  const CaseFolder folder;
  const std::string grasp = "grasp:\n  centre: [0, 0, 0]\n  rotation_deg: 10\n";
  write_pulled_bar(folder, kPulledBar + grasp);
  EXPECT_THROW(read_case(folder.path()), config::Error);  // about no axis
  folder.write("case.yaml", kPulledBar + grasp +
                                "  rotation_axis: [1, 0, 0]\n"
                                "  rotation_matrix: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n");
  EXPECT_THROW(read_case(folder.path()), config::Error);  // another rotation
  folder.write("case.yaml", std::string(kPulledBar) +
                                "grasp:\n  centre: [0, 0, 0]\n"
                                "  rotation_matrix: [[2, 0, 0], [0, 1, 0], [0, 0, 1]]\n");
  EXPECT_THROW(read_case(folder.path()), config::Error);
}

}  // namespace
}  // namespace palpate::cases
