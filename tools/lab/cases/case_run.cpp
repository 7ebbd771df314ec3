#include "tools/lab/cases/case_run.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "core/elasticity/element.hpp"

namespace palpate::cases {
namespace {

using Eigen::Matrix3Xd;

double thread_time_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

/// Steps a model and measures the times.
class Stepper {
 public:
  Stepper(elasticity::DeformationModel& model, const CaseProblem& problem)
      : model_(model), problem_(problem) {
    model_.prepare();
  }

  elasticity::StepReport step(double share) {
    model_.loads() = share * problem_.loads;
    model_.set_gravity(share * problem_.body.gravity_O);
    if (const auto pose = problem_.hand(share)) model_.hold(0, *pose);
    if (elasticity::Refactorisation* job = model_.wanted_refactorisation()) {
      job->run();
      model_.install(*job);
      ++times_.refactorisations;
    }
    const double begin = thread_time_us();
    const elasticity::StepReport report = model_.step(kTick);
    microseconds_.push_back(thread_time_us() - begin);
    iterations_ += report.iterations;
    times_.most_iterations = std::max(times_.most_iterations, report.iterations);
    return report;
  }

  StepTimes times() const {
    StepTimes times = times_;
    std::vector<double> sorted = microseconds_;
    std::sort(sorted.begin(), sorted.end());
    const auto quantile = [&sorted](double share) {
      return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
    };
    times.ticks = static_cast<int>(sorted.size());
    times.p50 = quantile(0.5);
    times.p99 = quantile(0.99);
    times.iterations = static_cast<double>(iterations_) / times.ticks;
    return times;
  }

 private:
  elasticity::DeformationModel& model_;
  const CaseProblem& problem_;
  StepTimes times_;
  long iterations_ = 0;
  std::vector<double> microseconds_;
};

double farthest(const Matrix3Xd& a, const Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

/// Nodal masses, kg: those of the corners, sufficient for an estimate.
Eigen::VectorXd lumped_mass(const elasticity::Body& body) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(body.mesh.node_count());
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int a = 0; a < 4; ++a) corners.col(a) = body.mesh.nodes.col(body.mesh.elements(a, e));
    const double m = body.material_of(e).density * elasticity::tetrahedron_volume(corners);
    for (int a = 0; a < 4; ++a) mass[body.mesh.elements(a, e)] += m / 4;
  }
  return mass;
}

/// Angular frequency (rad/s) of the body moving in the shape of its static displacement: Rayleigh
/// quotient with the work of all external forces, including reactions.
double frequency(const CaseProblem& problem, const elasticity::StaticSolution& equilibrium) {
  const Eigen::VectorXd mass = lumped_mass(problem.body);
  const Matrix3Xd u = equilibrium.positions - problem.body.mesh.nodes;
  const Matrix3Xd outer =
      problem.loads + equilibrium.reactions + problem.body.gravity_O * mass.transpose();
  const double work = (outer.array() * u.array()).sum();
  const double inertia = (u.colwise().squaredNorm() * mass).value();
  return inertia > 0 && work > 0 ? std::sqrt(work / inertia) : 1;
}

}  // namespace

elasticity::StaticSolution solve(const CaseProblem& problem) {
  const elasticity::Body& body = problem.body;
  const double size =
      (body.mesh.nodes.rowwise().maxCoeff() - body.mesh.nodes.rowwise().minCoeff()).norm();
  elasticity::StaticOptions options;
  // Rounding leaves about 1e-16 of the largest force that the material could exert.
  options.tolerance = std::max(1e-10, 1e-13 * body.material.young_modulus * size * size);
  return elasticity::solve_static(body, problem.loads, problem.held, options);
}

IncrementalRun run_incremental(const CaseProblem& problem, const Matrix3Xd& equilibrium, int ticks,
                               const elasticity::SolverOptions& options) {
  elasticity::SolverOptions exact = options;
  exact.accuracy = std::min(options.accuracy, 1e-9);  // only the final equilibrium is compared
  elasticity::CorotationalQuasistatic model(problem.body, exact);
  Stepper stepper(model, problem);
  for (int i = 1; i <= ticks; ++i) stepper.step(static_cast<double>(i) / ticks);
  IncrementalRun run;
  run.times = stepper.times();
  for (int i = 0; i < ticks && !run.converged; ++i)
    run.converged = stepper.step(1).status == elasticity::StepStatus::kConverged;
  run.deviation = farthest(model.positions(), equilibrium);
  return run;
}

DynamicRun run_dynamic(const CaseProblem& problem, const elasticity::StaticSolution& equilibrium,
                       const DynamicOptions& options) {
  DynamicRun run;
  run.mass_damping = options.mass_damping.value_or(2 * frequency(problem, equilibrium));
  elasticity::Body body = problem.body;
  body.damping = {run.mass_damping, options.stiffness_damping};
  elasticity::SolverOptions solver;
  solver.tolerance = 1e-9;  // residuals of each step accumulate until rest
  solver.accuracy = 0;
  elasticity::CorotationalDynamic model(body, solver);
  Stepper stepper(model, problem);
  const double largest = farthest(equilibrium.positions, body.mesh.nodes);
  int quiet = 0;
  while (run.seconds < options.seconds && !run.at_rest) {
    const double share = options.rise > 0 ? std::min(1.0, run.seconds / options.rise) : 1;
    const elasticity::StepReport report = stepper.step(share);
    run.seconds += kTick;
    run.deviation = farthest(model.positions(), equilibrium.positions);
    if (run.deviation > 0.01 * largest) run.settling_time = run.seconds;
    constexpr double kRest = 1e-5;   // 1/s, speed over largest displacement
    constexpr int kQuietTicks = 20;  // an oscillating body is never slow for that long
    const bool slow = share == 1 && report.status != elasticity::StepStatus::kFailed &&
                      model.velocities().colwise().norm().maxCoeff() < kRest * largest;
    quiet = slow ? quiet + 1 : 0;
    run.at_rest = quiet >= kQuietTicks;
  }
  run.times = stepper.times();
  run.positions = model.positions();
  run.grasp = model.reaction(0);
  return run;
}

}  // namespace palpate::cases
