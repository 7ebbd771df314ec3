#include "tools/lab/endurance/soak.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace palpate::endurance {
namespace {

TEST(Soak, WarmUpIsNoGrowthAndALeakIs) {
  std::vector<MemorySample> flat, leaking;
  for (int second = 0; second < 600; ++second) {
    const double time = second;
    flat.push_back({time, second < 30 ? 40.0 + second : 70.0});
    leaking.push_back({time, 70 + 0.5 * time / 60});
  }
  EXPECT_NEAR(memory_trend(flat).growth(), 0, 1e-12);
  EXPECT_NEAR(memory_trend(flat).slope, 0, 1e-12);
  EXPECT_NEAR(memory_trend(leaking).slope, 0.5, 1e-9);
  EXPECT_NEAR(memory_trend(leaking).growth(), 4, 1e-9);
  EXPECT_THROW(memory_trend({{0, 1}}), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::endurance
