// The object as other simulators get it, and the files for them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <regex>
#include <sstream>

#include "tests/unit/tools/fit/fit_folder.hpp"
#include "tools/fit/simulators/simulator_files.hpp"

namespace palpate::fit {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kBar[] =
    "frames:\n"
    "  object_in_base: {position: [1, 2, 3], rpy_deg: [0, 0, 90]}\n"
    "  sensor_in_flange: {position: [0, 0, 0]}\n"
    "  grasp_in_flange: {position: [0, 0, 0]}\n"
    "  gravity_in_base: [0, 0, -9.81]\n"
    "object:\n"
    "  mesh: {box: {size: [0.2, 0.04, 0.04], cells: [5, 1, 1]}}\n"
    "  order: quadratic\n"
    "  material: {young_modulus: 1e6, poisson_ratio: 0.3, density: 100}\n"
    "  fixed_box: {lower: [0, 0, 0], upper: [0, 0.04, 0.04]}\n"
    "  grasp_box: {lower: [0.16, 0, 0], upper: [0.2, 0.04, 0.04]}\n"
    "  gravity: true\n";

SoftObject read(const ExportOptions& options = {}, const std::vector<std::string>& changes = {}) {
  const FitFolder folder;
  folder.write("bar.yaml", kBar);
  const std::string file = (folder.path() / "bar.yaml").string();
  return read_soft_object(config::Node::load_file(file, changes), file, options);
}

/// Error of a configuration or a format; empty: none.
std::string complaint(const std::function<void()>& work) {
  try {
    work();
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

int occurrences(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  return static_cast<int>(std::distance(std::sregex_iterator(text.begin(), text.end(), regex), {}));
}

TEST(SoftObject, HasTheNodesOfTheQuadraticMeshInTheBase) {
  const SoftObject object = read();
  EXPECT_EQ(object.mesh.node_count(), 11 * 3 * 3);
  EXPECT_EQ(object.mesh.tetrahedron_count(), 8 * 6 * 5);
  EXPECT_EQ(object.fixed.size(), 9U);
  EXPECT_EQ(object.grasped.size(), 27U);
  // x of O is y of W
  const Eigen::Vector3d lower = object.mesh.nodes.rowwise().minCoeff();
  const Eigen::Vector3d upper = object.mesh.nodes.rowwise().maxCoeff();
  EXPECT_LT((lower - Eigen::Vector3d(0.96, 2, 3)).norm(), 1e-9);
  EXPECT_LT((upper - Eigen::Vector3d(1, 2.2, 3.04)).norm(), 1e-9);
  EXPECT_NEAR(object.masses().sum(), 100 * 0.2 * 0.04 * 0.04, 1e-9);
}

TEST(SoftObject, DividedFurtherHasThePartsOfItsBoxes) {
  const SoftObject object = read({ExportedGrasp::kHeld, 1});
  EXPECT_EQ(object.mesh.node_count(), 21 * 5 * 5);
  EXPECT_EQ(object.grasped.size(), 5U * 25);
  EXPECT_EQ(object.fixed.size(), 25U + 5 * 25);
}

/// A cantilever of a short bar, by Timoshenko's beam: q L^4 / (8 E I) + q L^2 / (2 k G A).
TEST(SoftObject, SinksUnderItsWeightAsABeamDoes) {
  const SoftObject object = read({}, {"object.mesh.box.cells=[10,2,2]"});
  const double E = 1e6, h = 0.04, L = 0.2, q = 100 * 9.81 * h * h, I = std::pow(h, 4) / 12;
  const double G = E / 2.6, k = 10 * 1.3 / (12 + 11 * 0.3);
  const double sag = q * std::pow(L, 4) / (8 * E * I) + q * L * L / (2 * k * G * h * h);
  EXPECT_NEAR(-object.largest_displacement().z(), sag, 0.03 * sag);
}

TEST(SoftObject, WhatNothingHoldsIsRejected) {
  EXPECT_THAT(complaint([] { read({}, {"object.fixed_box=~"}); }), HasSubstr("--grasp held"));
}

TEST(Mjcf, HasABodyForEachNodeThatMoves) {
  const SoftObject object = read();
  std::ostringstream out;
  write_mjcf(object, out);
  const std::string text = out.str();
  EXPECT_EQ(occurrences(text, "<body name=\"node_"), 99 - 9);
  EXPECT_EQ(occurrences(text, "world "), 9);
  EXPECT_THAT(text, HasSubstr("young=\"1e+06\" poisson=\"0.3\""));
  EXPECT_THAT(text, HasSubstr("gravity=\"0 0 -9.81\""));
}

TEST(Mjcf, HasAFlexForEachMaterial) {
  const SoftObject object =
      read({}, {"object.material.regions=[{box: {lower: [0.1, 0, 0], upper: [0.2, 0.04, 0.04]}, "
                "young_modulus: 3e6}]"});
  ASSERT_EQ(object.materials.size(), 2U);
  std::ostringstream out;
  write_mjcf(object, out);
  EXPECT_EQ(occurrences(out.str(), "<flex "), 2);
  EXPECT_THAT(out.str(), HasSubstr("young=\"3e+06\""));
  std::ostringstream rejected;
  EXPECT_THROW(write_drake_sdf(object, "model.vtk", rejected), config::Error);
  EXPECT_THROW(write_sofa(object, "model.vtk", rejected), config::Error);
}

TEST(DrakeSdf, FixesNodesBehindPlanes) {
  std::ostringstream free, held;
  write_drake_sdf(read(), "model.vtk", free);
  write_drake_sdf(read({ExportedGrasp::kHeld, 0}), "model.vtk", held);
  EXPECT_EQ(occurrences(free.str(), "<drake:wall_boundary_condition>"), 1);
  EXPECT_EQ(occurrences(held.str(), "<drake:wall_boundary_condition>"), 2);
  EXPECT_THAT(free.str(), HasSubstr("<uri>model.vtk</uri>"));
}

TEST(DrakeSdf, WhatLiesBehindNoPlaneIsRejected) {
  const SoftObject object =
      read({}, {"object.fixed_box={lower: [0.08, 0, 0], upper: [0.12, 0.04, 0.04]}"});
  std::ostringstream out;
  EXPECT_THAT(complaint([&] { write_drake_sdf(object, "model.vtk", out); }),
              HasSubstr("do not lie behind a plane"));
}

TEST(Vtk, HasAllNodesAndTetrahedra) {
  const SoftObject object = read();
  std::ostringstream out;
  write_vtk(object, out);
  EXPECT_THAT(out.str(), HasSubstr("POINTS 99 double"));
  EXPECT_THAT(out.str(), HasSubstr("CELLS 240 1200"));
  EXPECT_EQ(occurrences(out.str(), "\n10(?=\n)"), 240);
}

TEST(Remarks, NameWhatIsLeftOut) {
  const SoftObject object =
      read({}, {"obstacles=[{name: table, shape: half_space, pose: {position: [0, 0, 2]}, "
                "friction: 0.5}]"});
  ASSERT_EQ(object.left_out.size(), 1U);
  std::ostringstream out;
  write_mjcf(object, out);
  EXPECT_THAT(out.str(), HasSubstr("Left out: obstacle table."));
  EXPECT_THAT(out.str(), Not(HasSubstr("/bar.yaml")));
}

}  // namespace
}  // namespace palpate::fit
