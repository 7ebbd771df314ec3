#include "tools/lab/sensor_models/emulated_tactile.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace palpate::sensor_models {
namespace {

TEST(EmulatedTactile, MapHoldsOnPressesThatItHasNotSeen) {
  const EmulatedTactileScore score = score_emulated_tactile(3, 2000);
  EXPECT_EQ(score.rows, 2000);
  EXPECT_GT(score.mean_rms_norm, 0.3);  // there is contact
  EXPECT_LT(score.test_rms_norm, 0.6 * score.mean_rms_norm);
  EXPECT_LT(score.test_rms_norm, 1.5 * score.fit.training_rms.norm());
  EXPECT_EQ(score.fit.model.offset.norm(), 0);
}

TEST(EmulatedTactile, OneSeedGivesOneMap) {
  const auto map = [](std::uint64_t seed) {
    return score_emulated_tactile(seed, 50).fit.model.matrix;
  };
  EXPECT_EQ(map(1), map(1));
  EXPECT_NE(map(1), map(2));
}

TEST(EmulatedTactile, TooFewPressesAreRefused) {
  EXPECT_THROW(score_emulated_tactile(1, 2), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::sensor_models
