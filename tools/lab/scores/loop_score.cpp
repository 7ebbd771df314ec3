#include "tools/lab/scores/loop_score.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::scores {
namespace {

constexpr int kActive = 2;
constexpr int kFaulted = 4;
constexpr double kRounding = 1e-9;

struct Speeds {
  double linear, angular;
};

Speeds speeds(const double* twist) {
  return {Eigen::Map<const Eigen::Vector3d>(twist).norm(),
          Eigen::Map<const Eigen::Vector3d>(twist + 3).norm()};
}

/// Change of the command per time; a change towards rest counts as zero.
Speeds accelerations(const twist_command_t& from, const twist_command_t& to, double dt) {
  double change[6];
  for (int i = 0; i < 6; ++i) change[i] = (to.twist[i] - from.twist[i]) / dt;
  const Speeds before = speeds(from.twist), after = speeds(to.twist);
  const Speeds rate = speeds(change);
  return {after.linear > before.linear ? rate.linear : 0,
          after.angular > before.angular ? rate.angular : 0};
}

}  // namespace

LoopScore score_loop(const log::RunLog& run) {
  if (run.health.empty()) throw std::runtime_error("the log holds no HEALTH");
  const health_t& last = run.health.back();
  LoopScore score;
  score.cycles = last.cycles;
  score.overruns = last.overruns;
  score.allocations = last.allocations;
  score.page_faults = last.page_faults;
  score.overrun_ms = static_cast<double>(last.overrun_us) * 1e-3;
  if (last.phase_count > 0) {
    score.p50_us = last.p50_us[0];
    score.p99_us = last.p99_us[0];
    score.p999_us = last.p999_us[0];
    score.max_us = last.max_us[0];
    score.wake_up_max_us = last.max_us[last.phase_count - 1];
  }
  score.shapes_not_converged = last.shapes_not_converged;
  score.gate_limited = last.gate_limited;
  score.gate_rejected = last.gate_rejected;
  bool started = false;
  for (const health_t& health : run.health) {
    score.faulted = score.faulted || health.state == kFaulted;
    started = started || health.state == kActive;
    if (health.state == kActive) continue;
    if (started) score.reason = reinterpret_cast<const char*>(health.reason);
  }
  score.state = last.state;
  return score;
}

CommandScore check_commands(const log::RunLog& run, const control::GateLimits& limits,
                            double period) {
  CommandScore score;
  const twist_command_t* before = nullptr;
  for (const twist_command_t& command : run.commands) {
    ++score.commands;
    const bool finite =
        std::all_of(command.twist, command.twist + 6, [](double v) { return std::isfinite(v); });
    const Speeds speed = speeds(command.twist);
    score.linear_speed = std::max(score.linear_speed, speed.linear);
    score.angular_speed = std::max(score.angular_speed, speed.angular);
    bool good = finite && speed.linear <= limits.linear_speed * (1 + kRounding) &&
                speed.angular <= limits.angular_speed * (1 + kRounding);
    // A stopped daemon brakes; it must not accelerate.
    if (!command.valid && before != nullptr &&
        (speed.linear > speeds(before->twist).linear + kRounding ||
         speed.angular > speeds(before->twist).angular + kRounding))
      good = false;
    if (before != nullptr && command.session == before->session && command.seq > before->seq) {
      const Speeds rate =
          accelerations(*before, command, period * static_cast<double>(command.seq - before->seq));
      score.linear_acceleration = std::max(score.linear_acceleration, rate.linear);
      score.angular_acceleration = std::max(score.angular_acceleration, rate.angular);
      good = good && rate.linear <= limits.linear_acceleration * (1 + 1e-6) &&
             rate.angular <= limits.angular_acceleration * (1 + 1e-6);
    }
    if (!good) ++score.violations;
    before = &command;
  }
  for (const robot_state_t& state : run.robot) {
    const Eigen::Map<const Eigen::Array3d> p(state.position);
    if ((p < limits.workspace_lower.array() - 1e-3).any() ||
        (p > limits.workspace_upper.array() + 1e-3).any())
      ++score.outside_workspace;
  }
  return score;
}

}  // namespace palpate::scores
