#include "tools/lab/sensor_models/tactile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "rt/config/node.hpp"
#include "tests/support/recordings.hpp"

namespace palpate::sensor_models {
namespace {

TEST(Tactile, LinearMapHoldsOnTheSecondHalfOfTheFoamBar) {
  PALPATE_REQUIRE_RECORDING("biotac_foam_bar/ring_finger_dev.csv");
  const TactileForceScore score =
      score_tactile_force(support::recordings() / "biotac_foam_bar/ring_finger_dev.csv");
  EXPECT_LE(score.test_rms_norm, 0.03);
  EXPECT_GT(score.largest_test, 0.5);  // there is contact
  EXPECT_LT(score.test_rms_norm, 0.1 * score.mean_rms_norm);
}

TEST(Tactile, PlacesThePlateWithinTenDegrees) {
  PALPATE_REQUIRE_RECORDING("biotac_normal_dir/trial1_plate_contact.csv.gz");
  const std::filesystem::path file =
      support::recordings() / "biotac_normal_dir/trial1_plate_contact.csv.gz";
  sensing::LocalizationOptions options = normal_dir_localization(sensing::Weighting::kCentroid);
  const LocalizationScore score = score_localization(file, options);
  EXPECT_GT(score.contacts, 1000);
  EXPECT_LE(score.median, 10 * M_PI / 180);
  EXPECT_LT(score.median, 0.5 * score.mean_direction);
  // The other polarity selects the electrodes that are not pressed.
  options.polarity = 1;
  EXPECT_GT(score_localization(file, options).median, 2 * score.median);
}

TEST(Tactile, WritesItsMapAsYamlThatReadsBack) {
  sensing::LinearTactileModel model;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < sensing::kTactileInputCount; ++c)
      model.matrix(r, c) = 1e-3 * (r + 1) / (c - 10.5);
  model.offset << 0.25, -0.5, 1e-7;
  std::ostringstream out;
  write_tactile_yaml(model, out);
  const config::Node node = config::Node::from_text(out.str()).child("model");
  const char* const keys[] = {"force_x", "force_y", "force_z"};
  for (int r = 0; r < 3; ++r) {
    const std::vector<double> row = node.numbers(keys[r], sensing::kTactileInputCount);
    for (int c = 0; c < sensing::kTactileInputCount; ++c)
      EXPECT_NEAR(row[c], model.matrix(r, c), 1e-8 * std::abs(model.matrix(r, c)));
  }
  EXPECT_EQ(node.vector3("offset"), model.offset);
}

TEST(Tactile, AFolderWithoutItsRecordingsIsAnError) {
  std::ostringstream out;
  EXPECT_THROW(run_tactile({"/nowhere", "", ""}, out), std::runtime_error);
  EXPECT_THROW(run_tactile({support::recordings() / "biotac_normal_dir", "model.yaml", ""}, out),
               std::runtime_error);
}

}  // namespace
}  // namespace palpate::sensor_models
