#include "tools/lab/baselines/control/probes.hpp"

#include <gtest/gtest.h>

namespace palpate::baselines {
namespace {

TEST(Probes, MoveEveryAxisOnceAndStandStillBetween) {
  ProbeOptions options;
  options.distance = 0.02;
  options.angle = 0.1;
  Probes probes(options);
  math::Vector6d way = math::Vector6d::Zero();
  double time = 0;
  int settled = 0;
  while (!probes.done()) {
    const math::Vector6d twist = probes.step(1e-3).vector();
    EXPECT_LE((twist.array() != 0).count(), 1);
    way += 1e-3 * twist;
    time += 1e-3;
    ASSERT_LT(time, 60);
    if (!probes.take_settled()) continue;
    EXPECT_FALSE(probes.take_settled()) << "reported once";
    EXPECT_EQ(twist.norm(), 0) << "a probe ends at rest";
    ++settled;
    EXPECT_NEAR(way[settled - 1], settled <= 3 ? 0.02 : 0.1, 1e-9);
  }
  EXPECT_EQ(settled, 6);
  EXPECT_NEAR(time, probes.duration(), 6e-3);
}

TEST(Probes, RefuseWhatMovesNothing) {
  ProbeOptions options;
  options.distance = 0;
  EXPECT_THROW(Probes{options}, std::invalid_argument);
  options = {};
  options.move = -1;
  EXPECT_THROW(Probes{options}, std::invalid_argument);
}

}  // namespace
}  // namespace palpate::baselines
