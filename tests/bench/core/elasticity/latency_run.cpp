#include "tests/bench/core/elasticity/latency_run.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tests/bench/core/elasticity/baseline_model.hpp"

namespace palpate::bench {
namespace {

using Eigen::Matrix3Xd;

/// Nodal residual force of a converged solve, N at E = 1 Pa: 1e-9 N at 1e5 Pa.
constexpr double kConverged = 1e-14;

double distance(const Matrix3Xd& a, const Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

/// One baseline compared with the model.
class Baseline {
 public:
  Baseline(const Scenario& scenario, const LatencyOptions& options, BaselineModel::Solver solver,
           BaselineResult& result)
      : scenario_(scenario),
        dt_(options.dt),
        model_(scenario.body(), solver, options.mechanics == Mechanics::kDynamic),
        result_(result) {}

  /// The step twice from the same state: first to load its data into the caches, as in a program
  /// that does nothing else.
  void measure(double t, const Matrix3Xd& x, const Matrix3Xd& v, const Matrix3Xd& loads,
               const Matrix3Xd* converged) {
    for (const bool is_timed : {false, true}) {
      model_.restore(x, v);
      const math::Pose clamp = scenario_.clamp_pose(t);
      const double wall = wall_time(), cpu = thread_time();
      const bool good = model_.step(dt_, clamp, loads);
      if (!is_timed) continue;
      result_.times.cpu.add(thread_time() - cpu);
      result_.times.wall.add(wall_time() - wall);
      result_.assembly.add(model_.assembly_seconds());
      result_.iterations.add(model_.iterations());
      result_.failed += !good;
      if (good && converged != nullptr) {
        result_.error = std::max(result_.error, distance(model_.positions(), *converged));
      }
    }
  }

 private:
  const Scenario& scenario_;
  double dt_;
  BaselineModel model_;
  BaselineResult& result_;
};

class Pacer {
 public:
  explicit Pacer(double period) : period_(static_cast<long>(std::lround(period * 1e9))) {}
  void wait() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const long late = (now.tv_sec - next_.tv_sec) * kSecond + now.tv_nsec - next_.tv_nsec;
    if (late > period_) next_ = now;  // after a check: no burst to catch up
    next_.tv_nsec += period_;
    next_.tv_sec += next_.tv_nsec / kSecond;
    next_.tv_nsec %= kSecond;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next_, nullptr);
  }

 private:
  static constexpr long kSecond = 1000000000;
  long period_;
  timespec next_{};
};

}  // namespace

LatencyResult run_latency(const LatencyOptions& options) {
  LatencyResult result;
  const auto capacity = static_cast<std::size_t>(options.steps);
  for (Samples* s : {&result.step.wall, &result.step.cpu, &result.iterations, &result.factor_age,
                     &result.sensitivity_age}) {
    *s = Samples(capacity);
  }
  const Scenario scenario(options.mesh, options.motion, options.young_modulus, options.law);
  const Matrix3Xd& rest = scenario.body().mesh.nodes;
  const auto model = make_model(scenario.body(), options.mechanics, options.solver);
  RefactorService service(options.refactor);
  if (options.schedule) options.schedule();
  std::optional<BaselineModel> converged;
  if (options.checks > 0) {
    converged.emplace(scenario.body(), BaselineModel::Solver::kCholmod,
                      options.mechanics == Mechanics::kDynamic);
  }
  std::vector<std::unique_ptr<Baseline>> baselines;
  if (options.baselines) {
    baselines.push_back(std::make_unique<Baseline>(
        scenario, options, BaselineModel::Solver::kCholmod, result.cholmod));
    baselines.push_back(std::make_unique<Baseline>(scenario, options,
                                                   BaselineModel::Solver::kJacobiPcg, result.pcg));
  }
  Pacer pacer(options.dt);
  Matrix3Xd x_before = rest, v_before = rest, x_after = rest;
  // An odd stride, so that checks do not coincide with one phase of a motion.
  const long stride = std::max(1L, options.steps / std::max(1, options.checks)) | 1;
  bool is_disturbed = false;
  double end = 0;

  for (long k = 0; k < options.warm_up + options.steps; ++k) {
    const bool is_sampled = k >= options.warm_up;
    const bool is_checked = options.checks > 0 && is_sampled && (k - options.warm_up) % stride == 0;
    if (k == options.warm_up) end = wall_time() + options.seconds;
    const double t = options.dt * static_cast<double>(k + 1);
    scenario.apply(t, *model);
    if (is_checked) {
      x_before = model->positions();
      v_before = model->velocities();
    }
    if (options.paced) pacer.wait();

    const double wall = wall_time(), cpu = thread_time();
    service.collect(*model, k);
    const elasticity::StepReport report = model->step(options.dt);
    service.request(*model, k);
    const double cpu_taken = thread_time() - cpu, wall_taken = wall_time() - wall;
    service.run_here();

    if (!is_sampled) continue;
    if (!is_disturbed) {
      result.step.wall.add(wall_taken);
      result.step.cpu.add(cpu_taken);
    }
    is_disturbed = is_checked;  // the caches hold other data afterwards
    result.iterations.add(report.iterations);
    result.not_converged += report.status == elasticity::StepStatus::kNotConverged;
    result.failed += report.status == elasticity::StepStatus::kFailed;
    result.factor_age.add(options.dt * static_cast<double>(service.factor_age(k)));
    if (model->sensitivity().valid) result.sensitivity_age.add(model->sensitivity().age);
    if (is_checked) {
      x_after = model->positions();
      result.amplitude = std::max(result.amplitude, distance(x_after, rest));
      ++result.checks;
      converged->restore(x_before, v_before);
      const bool is_known = converged->converge(options.dt, scenario.clamp_pose(t), model->loads(),
                                                kConverged * options.young_modulus);
      const Matrix3Xd& x = converged->positions();
      if (is_known) result.error = std::max(result.error, distance(x_after, x));
      result.unknown += !is_known;
      for (auto& baseline : baselines) {
        baseline->measure(t, x_before, v_before, model->loads(), is_known ? &x : nullptr);
      }
    }
    if (wall_time() > end) break;
  }
  if (result.amplitude > 0) {
    for (double* e : {&result.error, &result.cholmod.error, &result.pcg.error}) {
      *e /= result.amplitude;
    }
  }
  result.refactorisations = service.count();
  result.refactor_wall = service.wall();
  result.refactor_cpu = service.cpu();
  return result;
}

}  // namespace palpate::bench
