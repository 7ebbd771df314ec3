// A run in lock-step may be slow, but must not stall for ever.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/lab/studies/study_folder.hpp"
#include "tools/lab/runs/live_run.hpp"

namespace palpate::evaluate {
namespace {

const std::filesystem::path kRoot = PALPATE_SOURCE_DIR;

runs::RunPlan plan_of(const std::string& setting) {
  runs::RunPlan plan;
  plan.name = "bar";
  plan.source.scene = kRoot / "sim/scenes/bar_long_soft_control_yield_markers.yaml";
  plan.source.scene_overrides = {setting};
  plan.source.duration = 0.4;
  plan.configuration = kRoot / "rt/config/examples/bar_long_soft.yaml";
  plan.lock_step = true;
  return plan;
}

TEST(Standstill, ARunWhoseSimulatorMakesNoHeadwayIsGivenUpAndSaysSo) {
  studies::StudyFolder folder;
  runs::RunPlan plan =
      plan_of("object.material.young_modulus=1e9");  // takes a long time for a tick
  plan.standstill = 1;
  common::Progress progress(1, 1, plan.name);
  try {
    runs::run_live(plan, folder.file("run"), progress);
    ADD_FAILURE() << "it came to its end";
  } catch (const runs::RunFailed& failure) {
    EXPECT_THAT(failure.what(), testing::HasSubstr("stands still"));
  }
}

TEST(Standstill, ARunThatMovesIsNot) {
  studies::StudyFolder folder;
  runs::RunPlan plan = plan_of("seed=1");
  common::Progress progress(1, 1, plan.name);
  const runs::RunFiles files = runs::run_live(plan, folder.file("run"), progress);
  EXPECT_TRUE(std::filesystem::exists(files.simulator));
}

}  // namespace
}  // namespace palpate::evaluate
