// Shape control of the long soft bar: one live run per target and level of model error.

#include "tools/common/interruption.hpp"
#include "tools/lab/demo/demo.hpp"
#include "tools/lab/demo/shape_drawing.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/score.hpp"

namespace palpate::demo {
namespace {

constexpr const char* kScene = "sim/scenes/bar_long_soft_control.yaml";
constexpr const char* kConfiguration = "rt/config/examples/bar_long_soft.yaml";
constexpr const char* kLevels[] = {"none", "all"};
constexpr double kLongest = 20;  // s, in which a target must be reached

scores::ScoredRun run_target(Demo& demo, const runs::ControlTarget& target,
                             const runs::Mismatch& mismatch) {
  scores::ScoredRun scored;
  scored.stage = "shape control, bar_long soft";
  scored.name = target.name;
  scored.mismatch = mismatch.name;
  runs::RunPlan plan;
  plan.name = "control " + target.name + " " + mismatch.name;
  plan.source.scene = demo.file(kScene);
  plan.source.scene_overrides = mismatch.scene;
  plan.configuration = demo.file(kConfiguration);
  plan.overrides = mismatch.daemon;
  for (const std::string& setting : target.daemon_overrides()) plan.overrides.push_back(setting);
  plan.duration = kLongest;
  plan.target = target;
  common::Progress progress(++demo.begun, demo.runs,
                            target.name + ", model error " + mismatch.name);
  try {
    const runs::RunFiles files = runs::run_live(plan, demo.log_folder(plan.name), progress);
    const log::RunLog log = log::read_run(files.control, files.housekeeping);
    scores::score_into(scored, log, scores::gate_of(plan));
    // Under model error the figure is reported, not judged.
    if (!scored.feature) throw runs::RunFailed("the log holds no target");
    if (mismatch.name == "none" && !scored.feature->within_5mm)
      scored.missed.push_back(
          "the plant's feature did not come to stay within 5 mm (and 1 degree)");
    draw_control(demo, scored, log, target);
    progress.finish(scored.missed.empty());
  } catch (const common::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    scored.failure = error.what();
  }
  return scored;
}

}  // namespace

int count_control(const Demo& demo) {
  const auto targets = runs::read_targets(demo.file("tools/lab/studies/targets.yaml"));
  return static_cast<int>(targets.size() * std::size(kLevels));
}

void run_control(Demo& demo) {
  const auto targets = runs::read_targets(demo.file("tools/lab/studies/targets.yaml"));
  for (const char* level : kLevels) {
    const runs::Mismatch mismatch = demo.mismatch(level, kScene, kConfiguration);
    for (const runs::ControlTarget& target : targets)
      demo.scored.push_back(run_target(demo, target, mismatch));
  }
}

}  // namespace palpate::demo
