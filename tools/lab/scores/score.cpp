#include "tools/lab/scores/score.hpp"

#include <iostream>
#include <nlohmann/json.hpp>

#include "rt/config/node.hpp"
#include "rt/registry/registry.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/output_files.hpp"

namespace palpate::scores {
namespace {

void check_limits(ScoredRun& scored, const log::RunLog& log, const Gate& gate) {
  scored.commands = check_commands(log, gate.limits, gate.period);
  const CommandScore& commands = *scored.commands;
  if (commands.violations > 0)
    scored.missed.push_back(std::to_string(commands.violations) + " of " +
                            std::to_string(commands.commands) +
                            " commands are beyond the gate's limits");
  if (commands.outside_workspace > 0) scored.missed.push_back("the hand left the workspace");
}

}  // namespace

Gate gate_of(const std::filesystem::path& configuration,
             const std::vector<std::string>& overrides) {
  const config::Node root = config::Node::load_file(configuration.string(), overrides);
  const double period_ms = root.child_or_empty("loop").number("period_ms", {0.25, 100}, 1.0);
  return {registry::read_gate_limits(root), period_ms * 1e-3};
}

Gate gate_of(const runs::RunPlan& plan) { return gate_of(plan.configuration, plan.overrides); }

void score_into(ScoredRun& scored, const log::RunLog& log, const Gate& gate,
                const runs::FeatureDefinition* steered, const math::Pose& X_OP) {
  scored.shape = score_shape(log, X_OP);
  scored.feature = score_feature(log, steered, X_OP);
  scored.loop = score_loop(log);
  if (scored.loop->faulted) scored.missed.push_back("palpated was faulted: " + scored.loop->reason);
  check_limits(scored, log, gate);
}

void check_poses(ScoredRun& scored, const std::filesystem::path& scene) {
  const auto motion = scenes::read_scene(config::Node::load_file(scene.string())).motion;
  const std::size_t poses = motion ? motion->legs().size() : 0;
  if (scored.shape->holds.size() < poses)
    scored.missed.push_back("only " + std::to_string(scored.shape->holds.size()) + " of " +
                            std::to_string(poses) + " poses were held");
}

int run_score(const ScoreOptions& options) {
  const log::RunLog log = log::read_run(options.control, options.housekeeping);
  ScoredRun scored;
  scored.stage = "score";
  scored.name = options.control.filename().string();
  scored.shape = score_shape(log);
  scored.feature = score_feature(log);
  scored.loop = score_loop(log);
  if (!options.scene.empty()) check_poses(scored, options.scene);
  if (!options.configuration.empty()) check_limits(scored, log, gate_of(options.configuration, {}));
  print_report({scored}, std::cout);
  if (!options.json.empty()) common::write_json(to_json(scored), options.json);
  return scored.missed.empty() ? 0 : 1;
}

}  // namespace palpate::scores
