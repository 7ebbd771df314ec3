#include "core/math/constants.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::math {
namespace {

/// To the last bit: numbers of recordings and golden runs hang on them.
TEST(Constants, AreTheNearestDoubles) {
  static_assert(kPi == M_PI);
  static_assert(kDegree == M_PI / 180);
  static_assert(kDegree == 0.017453292519943295);
  EXPECT_LE(std::abs(std::sin(kPi)), 1.3e-16);
}

}  // namespace
}  // namespace palpate::math
