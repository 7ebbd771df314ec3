// Every slot with a plug-in that errs in the loop, at a random cycle: its fallback takes over in
// that cycle, or the robot gets a zero command; no number that is not finite leaves the pipeline.
// PALPATE_PLUGIN_SEEDS sets the number of seeds of each row.

#include <cstdlib>
#include <random>

#include "tests/unit/rt/plugin/plugged_pipeline.hpp"

namespace palpate::plugin {
namespace {

int seeds() {
  const char* given = std::getenv("PALPATE_PLUGIN_SEEDS");
  return given == nullptr ? 2 : std::max(1, std::atoi(given));
}

struct Slot {
  const char* name;
  std::string (*configured)(const std::string& does, const std::string& more);
  const char* fallback;  // "": none
};

const Slot kSlots[] = {
    {"sensing", sensor, "{component: ft_tare_only, tare_samples: 10}"},
    {"contact", transformer, "{component: wrench_patch}"},
    {"estimation", estimator, "{component: pose_driven}"},
    {"deformation", model, "{component: corotational_quasistatic}"},
    {"feature", feature, "{component: point, rest_points: [[0.25, 0.03, 0.06]]}"},
    {"control_provider", provider, "{provider: fem, law: proportional_twist}"},
    {"control_law", law, "{provider: fem, law: proportional_twist}"},
};

class PluginFaults
    : public ::testing::TestWithParam<std::tuple<Slot, const char* /*does*/, bool /*fallback*/>> {};

TEST_P(PluginFaults, AreHandledInTheirCycle) {
  const auto& [slot, does, has_fallback] = GetParam();
  for (int seed = 0; seed < seeds(); ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const int after = std::uniform_int_distribution<int>(60, 120)(random);
    std::string more = ", after: " + std::to_string(after);
    if (has_fallback) more += std::string(", fallback: ") + slot.fallback;
    std::vector<std::string> overrides{kUnruly};
    if (slot.configured != sensor) overrides.push_back(sensor("nothing", ""));
    overrides.push_back(slot.configured(does, more));
    Running running(overrides);
    running.run(55);
    int pauses = 0;  // cycles without a command
    for (int cycle = 0; cycle < 145; ++cycle) {
      running.run(1);  // expects finite commands
      if (running.speed == 0) ++pauses;
    }
    const pipeline::Condition condition = running.pipeline.condition();
    if (has_fallback) {
      EXPECT_TRUE(running.pipeline.on_fallback()) << seed;
      EXPECT_EQ(condition.state, pipeline::LifeCycle::kDegraded) << seed << condition.reason;
      EXPECT_TRUE(running.pipeline.model().positions().allFinite());
      // A sensor's fallback tares first; a model without sensitivity steers nothing before.
      if (slot.configured != sensor && slot.configured != model) {
        EXPECT_EQ(pauses, 0) << seed;
      }
    } else {
      EXPECT_EQ(running.speed, 0) << seed;
      EXPECT_GE(static_cast<int>(condition.state), static_cast<int>(pipeline::LifeCycle::kDegraded))
          << seed << condition.reason;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, PluginFaults,
                         ::testing::Combine(::testing::ValuesIn(kSlots),
                                            ::testing::Values("throw", "throw_number", "nan",
                                                              "overrun"),
                                            ::testing::Bool()),
                         [](const auto& row) {
                           return std::string(std::get<0>(row.param).name) + "_" +
                                  std::get<1>(row.param) +
                                  (std::get<2>(row.param) ? "_with_fallback" : "");
                         });

}  // namespace
}  // namespace palpate::plugin
