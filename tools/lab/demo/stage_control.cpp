// Shape control of the long soft bar: one live run per target and level of model error.

#include "tools/common/interruption.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/demo/demo.hpp"
#include "tools/lab/demo/shape_drawing.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/score.hpp"

namespace palpate::demo {
namespace {

constexpr const char* kScene = "sim/scenes/bar_long_soft_control.yaml";
constexpr const char* kConfiguration = "rt/config/examples/bar_long_soft.yaml";
constexpr double kLongest = 20;  // s, in which a target must be reached
// m, at rest. Reached are 0.7 to 2.0 mm without model error.
constexpr double kErrorBar = 2.5e-3, kErrorBarUnderModelError = 5e-3;

/// Model errors of the i-th target: none, then a draw of its own.
std::string level_of(bool is_drawn, std::size_t i) {
  return is_drawn ? "calibrated " + std::to_string(i + 1) : "none";
}

void judge_control(scores::ScoredRun& run) {
  if (!run.feature) throw runs::RunFailed("the log holds no target");
  if (!run.feature->within_5mm)
    run.missed.push_back("the plant's feature did not come to stay within 5 mm (and 1 degree)");
  const double bar = run.mismatch == "none" ? kErrorBar : kErrorBarUnderModelError;
  if (run.feature->rest_distance > bar)
    run.missed.push_back("the plant's feature rests more than " + common::number(1e3 * bar, 1) +
                         " mm from its target");
}

scores::ScoredRun run_target(Demo& demo, const runs::ControlTarget& target,
                             const runs::Method& method, const runs::Mismatch& mismatch) {
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
  for (const std::string& setting : method.overrides) plan.overrides.push_back(setting);
  for (const std::string& setting : target.daemon_overrides()) plan.overrides.push_back(setting);
  plan.duration = kLongest;
  plan.target = target;
  common::Progress progress(++demo.begun, demo.runs,
                            target.name + ", model error " + mismatch.name);
  try {
    const runs::RunFiles files = runs::run_live(plan, demo.log_folder(plan.name), progress);
    const log::RunLog log = log::read_run(files.control, files.housekeeping);
    scores::score_into(scored, log, scores::gate_of(plan));
    judge_control(scored);
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
  return static_cast<int>(2 * targets.size());
}

void run_control(Demo& demo) {
  const auto targets = runs::read_targets(demo.file("tools/lab/studies/targets.yaml"));
  const runs::Method method =
      runs::read_methods(demo.file("tools/lab/studies/methods.yaml")).front();
  for (const bool is_drawn : {false, true})
    for (std::size_t i = 0; i < targets.size(); ++i)
      demo.scored.push_back(run_target(
          demo, targets[i], method, demo.mismatch(level_of(is_drawn, i), kScene, kConfiguration)));
}

}  // namespace palpate::demo
