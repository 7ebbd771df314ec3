#include "tools/lab/shapes/sagging_cylinder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rt/config/node.hpp"
#include "tests/support/recordings.hpp"
#include "tests/unit/tools/lab/shapes/shape_folder.hpp"

namespace palpate::shapes {
namespace {

using testing::HasSubstr;

std::string cylinder_error(const std::string& text) {
  const ShapeFolder folder;
  try {
    read_sagging_cylinder(folder.write("c.yaml", text));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

SaggingCylinder stiff_cylinder() {
  const ShapeFolder folder;
  return read_sagging_cylinder(folder.write("c.yaml", kCylinder));
}

TEST(SaggingCylinder, ReadsAnyNameAndNamesWhatIsWrong) {
  const SaggingCylinder c = stiff_cylinder();
  EXPECT_DOUBLE_EQ(c.length, 0.1);
  EXPECT_DOUBLE_EQ(c.radius, 0.005);
  EXPECT_DOUBLE_EQ(c.marker.y(), -0.002);
  EXPECT_DOUBLE_EQ(c.marker_deviation, 0.003);
  EXPECT_THAT(cylinder_error(with(kCylinder, "radius_mm: 5.0\n", "")), HasSubstr("radius_mm"));
  EXPECT_THAT(cylinder_error(with(kCylinder, "radius_mm: 5.0", "radius_mm: -5")),
              HasSubstr("allowed"));
  EXPECT_THAT(cylinder_error(with(kCylinder, "axis: z", "axis: w")), HasSubstr("axis"));
  EXPECT_THAT(cylinder_error(with(kCylinder, "young_modulus_Pa: 1.0e7\n", "")),
              HasSubstr("young_modulus_Pa"));
}

TEST(SaggingCylinder, ModulusFollowsFromMooneyAndRivlin) {
  const ShapeFolder folder;
  const SaggingCylinder c = read_sagging_cylinder(folder.write(
      "c.yaml", with(kCylinder, "young_modulus_Pa: 1.0e7", "mooney_rivlin_Pa: [300, 100]")));
  EXPECT_DOUBLE_EQ(c.young_modulus, 2400);
  EXPECT_DOUBLE_EQ(c.mooney, 0.25);
}

TEST(SaggingCylinder, MeshHasTheVolumeOfTheRoundBodyAndAHexagonsSecondMoment) {
  SaggingCylinder c = stiff_cylinder();
  for (c.axis = 0; c.axis < 3; ++c.axis) {
    const mesh::MeshWithGroups mesh = mesh_of(c, 1, 12);
    const SectionErrors errors = section_errors(c, mesh.mesh);
    EXPECT_NEAR(errors.volume, 0, 1e-9);
    // A hexagon of the circle's area: I / A^2 = 5 sqrt(3) / 108 against 1 / (4 pi).
    EXPECT_NEAR(errors.second_moment, 5 * std::sqrt(3.0) / 108 * 4 * M_PI - 1, 1e-9);
    EXPECT_NEAR(mesh.mesh.nodes.row(c.axis).maxCoeff(), c.length, 1e-12);
  }
  EXPECT_LT(section_errors(stiff_cylinder(), mesh_of(stiff_cylinder(), 3, 3).mesh).second_moment,
            0.002);
}

TEST(SaggingCylinder, SagsAsTheTheoryOfBeamsSaysWhereItIsStiff) {
  const SaggingCylinder c = stiff_cylinder();
  const double area = M_PI * c.radius * c.radius, second = area * c.radius * c.radius / 4;
  const double load = c.density * 9.81 * area;  // N/m
  const double shear = c.young_modulus / 3 * 0.9 * area;
  const double sag = load * std::pow(c.length, 4) / (8 * c.young_modulus * second) +
                     load * c.length * c.length / (2 * shear);
  const std::vector<ShapeResult> results = score_sagging_cylinder(c);
  ASSERT_EQ(results.size(), 3u);
  EXPECT_EQ(results[0].nodes, 475);
  for (const ShapeResult& result : results) {
    // The height is the third score, relative to a marker at -2 mm.
    const double height = result.scores[2].error - 2;
    const double share = result.nodes == 475 ? 0.08 : 0.04;  // coarse elements are too stiff
    EXPECT_NEAR(height, -1e3 * sag, share * 1e3 * sag) << result.model;
  }
}

TEST(SaggingCylinder, EndFaceOfTheRecordedOneIsPredictedWithinItsGoalOnTheFinerMesh) {
  PALPATE_REQUIRE_RECORDING("pdms_cylinder_gravity/case.yaml");
  const SaggingCylinder c =
      read_sagging_cylinder(support::recordings() / "pdms_cylinder_gravity/case.yaml");
  for (const ShapeResult& result : score_sagging_cylinder(c)) {
    EXPECT_GE(result.nodes, 475);
    // The coarse mesh misses the goal of 4 mm, by 2 mm.
    EXPECT_LE(result.scores[0].error, result.nodes == 475 ? 6.5 : 4) << result.model;
  }
}

}  // namespace
}  // namespace palpate::shapes
