#include "tools/lab/shapes/hanging_beam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rt/config/node.hpp"
#include "tests/support/recordings.hpp"
#include "tests/unit/tools/lab/shapes/shape_folder.hpp"
#include "tools/lab/shapes/beam_score.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::shapes {
namespace {

using testing::HasSubstr;

HangingBeams read(const std::string& text, const std::string& corners = kCorners) {
  const ShapeFolder folder;
  folder.write("first_corners.csv", corners);
  return read_hanging_beams(folder.write("any.yaml", text));
}

std::string beam_error(const std::string& text) {
  try {
    read(text);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "";
}

const ShapeScore& score_of(const ShapeResult& result, const std::string& beginning) {
  for (const ShapeScore& score : result.scores)
    if (score.quantity.rfind(beginning, 0) == 0) return score;
  throw std::runtime_error("no score " + beginning);
}

TEST(HangingBeam, ReadsACase) {
  const HangingBeams beams = read(kBeam);
  ASSERT_EQ(beams.cases.size(), 1u);
  EXPECT_NEAR(beams.block.min().y(), -0.03, 1e-12);
  const BeamCase& c = beams.cases[0];
  EXPECT_EQ(c.name, "first");
  ASSERT_EQ(c.parts.size(), 1u);
  EXPECT_EQ(c.parts[0].material, "Soft");
  ASSERT_EQ(c.corners.size(), 2u);
  EXPECT_DOUBLE_EQ(c.corners[0].measured.x(), -0.14);
  EXPECT_DOUBLE_EQ(c.edge_deviation, 1.5e-3);
  EXPECT_EQ(c.lower_edge.cols(), 0);
}

TEST(HangingBeam, TwoMaterialsMeetWhereTheCaseSays) {
  const std::string two = with(kBeam, "material: Soft", "material: Soft + Hard");
  const HangingBeams assumed = read(two);
  EXPECT_TRUE(assumed.cases[0].is_interface_assumed);
  EXPECT_NEAR(assumed.cases[0].parts[0].lower, -0.07, 1e-12);
  const HangingBeams stated =
      read(with(two, "    material", "    interface_rest_x_mm: -50\n    material"));
  ASSERT_EQ(stated.cases[0].parts.size(), 2u);
  EXPECT_FALSE(stated.cases[0].is_interface_assumed);
  EXPECT_EQ(stated.cases[0].parts[1].material, "Hard");
  EXPECT_NEAR(stated.cases[0].parts[1].upper, -0.05, 1e-12);
}

TEST(HangingBeam, NamesWhatIsWrong) {
  EXPECT_THAT(beam_error(with(kBeam, "    block_rotation_deg: 0\n", "")),
              HasSubstr("cases.first.block_rotation_deg"));
  EXPECT_THAT(beam_error(with(kBeam, "block_rotation_deg: 0", "block_rotation_deg: 400")),
              HasSubstr("allowed"));
  EXPECT_THAT(beam_error(with(kBeam, "[0, 0, -1]]", "[0, 0, 1]]")), HasSubstr("camera_R"));
  EXPECT_THAT(beam_error(with(kBeam, "bar: [140", "bar: [130")), HasSubstr("bar_rest_x"));
  EXPECT_THAT(beam_error(with(kBeam, "material: Soft", "material: Soft +")), HasSubstr("material"));
  EXPECT_THROW(read(kBeam, "corner,rest_x_mm\nA,1\n"), recordings::CsvError);
}

TEST(HangingBeam, FitFindsTheModulusThatMadeTheDropAndPredictsTheRest) {
  HangingBeams beams = read(kBeam);
  BeamCase& made = beams.cases[0];
  const BeamModel model(beams, made.parts);
  const BlockPose pose = model.block_pose(model.rest({250e3}, Law::kCorotational));
  made.centre = pose.centre;
  made.rotation = pose.rotation;
  made.corners.clear();
  const DropFit fit = fit_to_drop(model, made.centre.y(), 2e-3, Law::kCorotational);
  EXPECT_NEAR(fit.young_modulus, 250e3, 100);
  EXPECT_GT(fit.deviation, 1e3);
  const std::vector<ShapeScore> scores =
      compare_beam(beams, made, model, model.rest({fit.young_modulus}, Law::kCorotational), true);
  EXPECT_NEAR(scores[1].error, 0, 0.01);
  EXPECT_NEAR(scores[2].error, 0, 0.01);
  EXPECT_TRUE(scores[0].is_fitted);
  EXPECT_FALSE(scores[2].is_fitted);
}

TEST(HangingBeam, CompositeHangsBetweenBeamsOfItsMaterials) {
  const HangingBeams beams = read(with(kBeam, "material: Soft", "material: Soft + Hard"));
  const BeamModel composite(beams, beams.cases[0].parts);
  const auto drop = [&](double at_clamp, double free) {
    return composite.block_pose(composite.rest({at_clamp, free}, Law::kCorotational)).centre.y();
  };
  const double hard = drop(400e3, 400e3), soft = drop(150e3, 150e3);
  const double soft_at_clamp = drop(150e3, 400e3), hard_at_clamp = drop(400e3, 150e3);
  EXPECT_LT(soft, soft_at_clamp);
  EXPECT_LT(soft_at_clamp, hard_at_clamp);  // the part at the clamp carries the larger moment
  EXPECT_LT(hard_at_clamp, hard);
  // One material throughout is the beam of one part, apart from the mesh.
  const BeamModel plain(beams, {beams.cases[0].parts[0]});
  EXPECT_NEAR(plain.block_pose(plain.rest({400e3}, Law::kCorotational)).centre.y(), hard,
              0.01 * std::abs(hard));
  EXPECT_THROW(composite.rest({150e3, 400e3}, Law::kHyperelastic), std::invalid_argument);
}

TEST(HangingBeam, CompositeWithoutModuliIsNotPredicted) {
  const HangingBeams beams = read(with(kBeam, "material: Soft", "material: Soft + Hard"));
  const std::vector<ShapeResult> results = score_hanging_beams({beams}, {{"Soft", 2e5}});
  ASSERT_EQ(results.size(), 1u);
  EXPECT_TRUE(results[0].scores.empty());
  EXPECT_THAT(results[0].notes.at(0), HasSubstr("Hard"));
}

TEST(HangingBeam, EdgeOfTheModelItselfHasNoError) {
  HangingBeams beams = read(kBeam);
  BeamCase& c = beams.cases[0];
  // Straight at rest and recorded 1.5 mm below.
  c.lower_edge =
      (Eigen::Matrix2Xd(2, 3) << -0.01, -0.05, -0.1, -0.0165, -0.0165, -0.0165).finished();
  const BeamModel model(beams, c.parts);
  ShapeResult result;
  result.scores = compare_beam(beams, c, model, model.rest({1e9}, Law::kCorotational), false);
  EXPECT_NEAR(score_of(result, "lower edge, RMS").error, 1.5, 0.02);
  EXPECT_NEAR(score_of(result, "corners, largest").error, 0, 0.05);
  EXPECT_TRUE(result.met());
}

TEST(HangingBeam, RecordedBeamsArePredictedAsPublished) {
  PALPATE_REQUIRE_RECORDING("silicone_beams_diffcal/truth.yaml");
  const HangingBeams beams =
      read_hanging_beams(support::recordings() / "silicone_beams_diffcal/truth.yaml");
  ASSERT_EQ(beams.cases.size(), 2u);
  for (const BeamCase& c : beams.cases) {
    const BeamModel model(beams, c.parts);
    const DropFit fit = fit_to_drop(model, c.centre.y(), c.centre_deviation, Law::kCorotational);
    ShapeResult result;
    result.scores =
        compare_beam(beams, c, model, model.rest({fit.young_modulus}, Law::kCorotational), true);
    // The goal of 2 degrees is missed for the softer beam, with 2.8.
    EXPECT_LE(std::abs(score_of(result, "block's rotation").error), c.name == "h_e_c" ? 3 : 2)
        << c.name;
    EXPECT_LE(score_of(result, "lower edge, RMS").error, c.edge_deviation > 2e-3 ? 4 : 2) << c.name;
  }
}

}  // namespace
}  // namespace palpate::shapes
