// Elements turned inside out, solvers that do not get there.

#include <cmath>

#include "tools/faults/rows.hpp"
#include "tools/faults/transforms.hpp"

namespace palpate::faults {
namespace {

constexpr int kStates = 100;  // of a seed
constexpr int kRefactorDelay = 5;

/// A step, with the factor that it asks for some steps later, as in the loop.
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

/// Random states of the mechanics: nodes thrown about by up to three times the object's size, or
/// forces a hundred times too large. Unloaded again it must come back to rest.
RunResult run_states(const Bench&, std::uint64_t seed) {
  math::Random random(seed, "states");
  component::Pipeline pipeline(configuration(), kTick, true);
  elasticity::DeformationModel& model = pipeline.model();
  Stepper stepper(model);
  for (int i = 0; i < 300; ++i) stepper.step();
  const Eigen::Matrix3Xd rest = model.positions();
  const Eigen::Matrix3Xd still = Eigen::Matrix3Xd::Zero(3, rest.cols());
  const double size = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).maxCoeff();

  RunResult result;
  int strayed = 0;
  for (int state = 0; state < kStates; ++state) {
    const double reach = random.uniform(0, 3) * size;
    const bool by_force = random.below(2) == 0;
    Eigen::Matrix3Xd x = rest;
    for (double& number : x.reshaped()) number += by_force ? 0 : random.uniform(-reach, reach);
    if (!model.restore(x, still)) result.fail("a finite state is refused");
    model.loads().setZero();
    if (by_force) {
      for (double& force : model.loads().reshaped()) force = random.uniform(-100, 100);  // N
      for (int i = 0; i < 20; ++i) stepper.step();
      if (!model.positions().allFinite()) result.fail("positions are not finite");
      x = model.positions();
      model.loads().setZero();
    }
    const double allowed = 0.01 * (x - rest).colwise().norm().maxCoeff();
    int steps = 0;
    const auto away = [&] { return (model.positions() - rest).colwise().norm().maxCoeff(); };
    while (steps < 500 && !(away() <= allowed)) {
      stepper.step();
      ++steps;
      if (!model.positions().allFinite() || !model.reaction(0).vector().allFinite())
        result.fail("a number is not finite");
    }
    if (!(away() <= allowed)) ++strayed;
    if (result.outcome == Outcome::kFailed) break;
  }
  result.measured = 100.0 * strayed / kStates;
  return result;
}

RunResult run_thrown(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "thrown");
  const Window window{0.25 + random.uniform(0, 0.05), 0.55};
  const Stream faulted =
      throw_about(bench.recording.stream, window, 1.5, random);  // m, three times the size
  const Trace trace = Replay(bench.recording).run(faulted, 1200);
  const Window from{first_difference(faulted, bench.recording.stream), window.end};
  RunResult result = judge(trace, bench.reference, from, true);
  result.measured = trace.not_finite + trace.beyond_limits;
  if (trace.cycles.back().state != component::LifeCycle::kActive)
    result.note("not active 0.65 s later");
  return result;
}

/// One iteration a cycle and a tolerance that nobody can meet, while the hand is shaken.
RunResult run_not_converging(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "iterations");
  const Window window{1e-3 * kStartTick, 0.6};
  const Stream shaken =
      throw_about(bench.recording.stream, {0.1, 0.6}, random.uniform(0, 0.01), random);
  Replay replay(bench.recording, {"deformation={component: corotational_quasistatic, iterations: "
                                  "1, tolerance: 1e-12, accuracy: 0}"});
  bool bounded = true, reported = true;
  const Trace trace = replay.run(shaken, 600, [&](int, daemon::Now&) {
    const elasticity::StepReport& step = replay.daemon().pipeline().estimate().step;
    bounded = bounded && step.iterations <= 1;
    reported = reported && std::isfinite(step.residual);
    return true;
  });
  RunResult result = judge(trace, bench.reference, window, true);
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
      {"17", "100 random states, forces x100", "0 NaN, 99.9 % back at rest in 500 steps",
       "% strayed", 0.1, true, run_states},
      {"17", "hand's pose thrown 3 sizes far", "0 NaN, 0 commands beyond limits", "", 0, false,
       run_thrown},
      {"18", "one iteration, no convergence", "bounded, shown in 100 ms", "ms", 100, false,
       run_not_converging},
  };
}

}  // namespace palpate::faults
