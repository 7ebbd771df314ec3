#include "tools/lab/endurance/cycle_cost.hpp"

#include <gtest/gtest.h>

#include "rt/config/node.hpp"

namespace palpate::endurance {
namespace {

const std::filesystem::path kConfiguration =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft_limits.yaml";

TEST(CycleCost, IsMeasuredByPartAndAllocatesNothing) {
  constexpr int kCycles = 300;
  const CycleCost cost = measure_cycle_cost(
      kConfiguration,
      {"object.mesh.box.cells=[10, 1, 1]", "estimation={component: pose_wrench_filter}"}, kCycles);
  EXPECT_EQ(cost.nodes, 21 * 3 * 3);
  EXPECT_EQ(cost.allocations, 0);
  EXPECT_GT(cost.factors, 0) << "the hand moves, and factors follow";
  std::int64_t parts = 0;
  for (const loop::LatencyHistogram* part : {&cost.estimator, &cost.jacobian, &cost.program}) {
    EXPECT_EQ(part->count(), kCycles);
    EXPECT_GT(part->quantile_ns(0.5), 100) << "it does something";
    parts += part->quantile_ns(0.5);
  }
  EXPECT_EQ(cost.together.count(), kCycles);
  EXPECT_GT(cost.together.quantile_ns(0.5), parts / 2);
  EXPECT_GE(cost.together.max_ns(), cost.estimator.max_ns());
}

TEST(CycleCost, WhatIsConfiguredWronglyIsSaid) {
  EXPECT_THROW(measure_cycle_cost(kConfiguration, {"control.limits={force: -1}"}, 10),
               config::Error);
}

}  // namespace
}  // namespace palpate::endurance
