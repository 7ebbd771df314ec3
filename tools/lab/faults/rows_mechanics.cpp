// Inverted elements, solvers that do not converge.

#include <algorithm>
#include <cmath>

#include "tools/lab/faults/rows.hpp"
#include "tools/lab/faults/scenario.hpp"

namespace palpate::faults {
namespace {

constexpr int kRefactorDelay = 5;

/// A step, with the factorisation that it requests delivered a few steps later, as in the loop.
class Stepper {
 public:
  explicit Stepper(elasticity::DeformationModel& model) : model_(model) {}
  void step() {
    if (job_ == nullptr && (job_ = model_.wanted_refactorisation()) != nullptr) {
      job_->run();
      due_ = kRefactorDelay;
    }
    if (job_ != nullptr && due_-- <= 0) model_.install(*std::exchange(job_, nullptr));
    model_.step(kTick);
  }

 private:
  elasticity::DeformationModel& model_;
  elasticity::Refactorisation* job_ = nullptr;
  int due_ = 0;
};

/// Ways to put the mechanics into a state that no real object has.
enum class Disturbance {
  kNodes,    // each node displaced by up to three times the object's size
  kContact,  // a contact force of 1 N, a hundred times too large, on some node
  kLoads,    // of the same order on every node
};

void load(elasticity::DeformationModel& model, Disturbance disturbance, math::Random& random) {
  constexpr double kForce = 100;  // N
  Eigen::Matrix3Xd& loads = model.loads();
  if (disturbance == Disturbance::kContact) {
    auto force = loads.col(static_cast<Eigen::Index>(random.below(loads.cols())));
    for (double& x : force) x = random.normal();
    force *= kForce / force.norm();
  } else {
    for (double& x : loads.reshaped()) x = random.uniform(-kForce, kForce);
  }
}

/// Longest side of the bounding box, m.
double extent(const Eigen::Matrix3Xd& positions) {
  return (positions.rowwise().maxCoeff() - positions.rowwise().minCoeff()).maxCoeff();
}

/// Whether some node has moved by more than 2 % of the size between two cycles.
bool is_jump(const Eigen::Matrix3Xd& before, const Eigen::Matrix3Xd& now) {
  return before.cols() == now.cols() &&
         !((now - before).cwiseAbs().maxCoeff() <= 0.02 * extent(before));
}

/// Puts the model into one such state, and back: false if 500 steps after it do not lead to rest.
bool comes_back(elasticity::DeformationModel& model, Stepper& stepper, const Eigen::Matrix3Xd& rest,
                Disturbance disturbance, math::Random& random, RunResult& result) {
  Eigen::Matrix3Xd x = rest;
  const double reach = random.uniform(0, 3) * extent(rest);
  if (disturbance == Disturbance::kNodes)
    for (double& number : x.reshaped()) number += random.uniform(-reach, reach);
  const Eigen::Matrix3Xd still = Eigen::Matrix3Xd::Zero(3, rest.cols());
  if (!model.restore(x, still)) result.fail("a finite state is refused");
  model.loads().setZero();
  const auto step = [&] {
    stepper.step();
    if (!model.positions().allFinite() || !model.reaction(0).vector().allFinite())
      result.fail("a number is not finite");
  };
  if (disturbance != Disturbance::kNodes) {
    load(model, disturbance, random);
    for (int i = 0; i < 20; ++i) step();
    x = model.positions();
    model.loads().setZero();
  }
  const auto away = [&rest](const Eigen::Matrix3Xd& now) {
    return (now - rest).colwise().norm().maxCoeff();
  };
  constexpr double kAccuracy = 1e-6;  // m; a force on a constrained node has no effect
  const double allowed = std::max(kAccuracy, 0.01 * away(x));
  for (int i = 0; i < 500 && !(away(model.positions()) <= allowed); ++i) step();
  return away(model.positions()) <= allowed;
}

Row states_row(const std::string& name, Disturbance disturbance, int states, double limit) {
  Row row{"17",
          std::to_string(states) + " states: " + name,
          "0 NaN, 99.9 % back at rest in 500 steps",
          "% strayed",
          limit,
          true,
          {}};
  row.run = [=](const Bench&, std::uint64_t seed) {
    math::Random random(seed, name);
    pipeline::Pipeline pipeline(configuration(), kTick, true);
    Stepper stepper(pipeline.model());
    for (int i = 0; i < 300; ++i) stepper.step();
    const Eigen::Matrix3Xd rest = pipeline.model().positions();
    RunResult result;
    int strayed = 0;
    for (int i = 0; i < states && result.outcome != Outcome::kFailed; ++i)
      strayed += comes_back(pipeline.model(), stepper, rest, disturbance, random, result) ? 0 : 1;
    result.measured = 100.0 * strayed / states;
    return result;
  };
  return row;
}

Scenario thrown(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "thrown");
  const Window window{0.25 + random.uniform(0, 0.05), 0.55};
  Scenario scenario;
  scenario.stream =
      throw_about(bench.recording.stream, window, 1.5, random);  // m, three times the size
  scenario.window = from_first(scenario.stream, bench, window);
  scenario.ticks = 1200;
  return scenario;
}

/// `each`: before every cycle. `harms`: whether the fault must be reported even if the shape does
/// not jump.
RunResult run_and_look_for_jumps(const Bench& bench, const Scenario& scenario, bool harms,
                                 const std::function<void(int, pipeline::Pipeline&)>& each) {
  Replay replay(bench.recording, scenario.overrides);
  bool jumped = false;
  Eigen::Matrix3Xd before;
  const Trace trace = replay.run(scenario.stream, scenario.ticks, [&](int tick, daemon::Now&) {
    pipeline::Pipeline& pipeline = replay.daemon().pipeline();
    const Eigen::Matrix3Xd& shape = pipeline.model().positions();
    jumped = jumped || (pipeline.is_running() &&
                        (pipeline.estimate().step.restarted || is_jump(before, shape)));
    if (pipeline.is_running()) before = shape;
    each(tick, pipeline);
    return true;
  });
  RunResult result = judge(trace, bench.reference, scenario.window, harms || jumped);
  result.measured = trace.not_finite + trace.beyond_limits;
  const bool reported = std::any_of(trace.events.begin(), trace.events.end(),
                                    [](const EventNote& event) { return event.event == "jump"; });
  if (jumped && !reported) result.fail("it jumps, and no event reports it");
  if (trace.cycles.back().state != pipeline::LifeCycle::kActive)
    result.note("not active 0.65 s later");
  return result;
}

RunResult run_thrown(const Bench& bench, std::uint64_t seed) {
  return run_and_look_for_jumps(bench, thrown(bench, seed), true, [](int, pipeline::Pipeline&) {});
}

/// Each node is displaced by up to three times the object's size while palpated controls it. A
/// displacement so small that the cycle's own step corrects it leaves nothing to report.
RunResult run_thrown_shape(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "thrown shape");
  Scenario scenario;
  const int tick = 300 + static_cast<int>(random.below(50));
  scenario.window = {kTick * tick, kTick * (tick + 200)};
  scenario.ticks = 1200;
  scenario.stream = bench.recording.stream;
  return run_and_look_for_jumps(bench, scenario, false, [&](int now, pipeline::Pipeline& pipeline) {
    if (now != tick) return;
    Eigen::Matrix3Xd x = pipeline.model().positions();
    const double reach = random.uniform(0, 3) * extent(x);
    for (double& number : x.reshaped()) number += random.uniform(-reach, reach);
    pipeline.model().restore(x, Eigen::Matrix3Xd::Zero(3, x.cols()));
  });
}

/// One iteration per cycle and an unattainable tolerance, while the hand is shaken.
Scenario one_iteration(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "iterations");
  Scenario scenario;
  scenario.window = {1e-3 * kStartTick, 0.6};
  scenario.ticks = 600;
  scenario.stream =
      throw_about(bench.recording.stream, {0.1, 0.6}, random.uniform(0, 0.01), random);
  scenario.overrides = {
      "deformation={component: corotational_quasistatic, iterations: 1, tolerance: 1e-12, "
      "accuracy: 0}"};
  return scenario;
}

RunResult run_not_converging(const Bench& bench, std::uint64_t seed) {
  const Scenario scenario = one_iteration(bench, seed);
  Replay replay(bench.recording, scenario.overrides);
  bool bounded = true, reported = true;
  const Trace trace = replay.run(scenario.stream, scenario.ticks, [&](int, daemon::Now&) {
    const elasticity::StepReport& step = replay.daemon().pipeline().estimate().step;
    bounded = bounded && step.iterations <= 1;
    reported = reported && std::isfinite(step.residual);
    return true;
  });
  RunResult result = judge(trace, bench.reference, scenario.window, true);
  result.measured = 1e3 * result.visible;
  if (!bounded) result.fail("more than one iteration in a cycle");
  if (!reported) result.fail("the residual is not finite");
  if (replay.daemon().counters().shapes_not_converged < 100)
    result.note("steps are said to converge");
  return result;
}

}  // namespace

std::vector<Row> mechanics_rows() {
  return {
      states_row("nodes thrown 3 sizes far", Disturbance::kNodes, 100, 0.1),
      states_row("contact force x100", Disturbance::kContact, 20, 0.1),
      states_row("100 N on every node", Disturbance::kLoads, 20, 0.1),
      {"17", "hand's pose thrown 3 sizes far", "0 NaN, 0 commands beyond limits", "", 0, false,
       run_thrown, thrown},
      {"17", "the running shape thrown 3 sizes far", "0 NaN, 0 commands beyond limits", "", 0,
       false, run_thrown_shape},
      {"18", "one iteration, no convergence", "bounded, shown in 100 ms", "ms", 100, false,
       run_not_converging, one_iteration},
  };
}

}  // namespace palpate::faults
