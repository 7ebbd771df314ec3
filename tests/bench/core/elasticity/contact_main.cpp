// Contact with friction: time of a step against the number of points in contact, and its accuracy,
// of the model (cone problem with compliances), of a smooth potential in its place, and of Newton's
// method with a refactorisation in each iteration; or many random steps. Thread time, so that other
// processes count for less.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>

#include "core/elasticity/corotational_model.hpp"
#include "rt/config/command_line.hpp"
#include "tests/bench/core/elasticity/contact_penalty.hpp"
#include "tests/bench/core/elasticity/contact_random.hpp"
#include "tests/bench/core/elasticity/samples.hpp"

namespace palpate::bench {
namespace {

struct Options {
  int steps = 4000;
  int delay = 20;  // steps between a snapshot and its factor
  int checks = 40;
  double friction = 0.3;
  bool single = false;  // precision inside elements
  int sweeps = elasticity::ContactOptions().sweeps;
  PenaltyOptions penalty;
  std::string csv;
};

/// What a formulation did in a run.
struct Tally {
  explicit Tally(std::string title) : name(std::move(title)) {}

  std::string name;
  std::map<int, Samples> by_contacts;  // s, by tens of points under force
  Samples all, errors, newton;         // s, m, s
  long iterations = 0, steps = 0, newton_iterations = 0;
  double deepest = 0;     // m, penetration
  double largest = 0;     // m, displacement
  int not_converged = 0;  // checks

  void add(double taken, int pressing, int iterations_made) {
    by_contacts[(pressing + 9) / 10].add(taken);
    all.add(taken);
    iterations += iterations_made;
    ++steps;
  }
};

/// Compares a step with the same one by Newton's method from the same state.
class Check {
 public:
  Check(const ContactScene& scene, Tally& tally) : scene_(scene), newton_(scene), tally_(tally) {}

  void before(const Eigen::Matrix3Xd& positions,
              const std::vector<elasticity::SurfaceContact>& contacts) {
    newton_.restore(positions, contacts);
  }
  void after(const math::Pose& hand, const Eigen::Matrix3Xd& positions) {
    const double begin = thread_time();
    const bool converged = newton_.step(hand);
    const double taken = thread_time() - begin;
    if (!converged) {
      ++tally_.not_converged;
      return;
    }
    tally_.newton.add(taken);
    tally_.newton_iterations += newton_.iterations();
    tally_.errors.add((positions - newton_.positions()).colwise().norm().maxCoeff());
    const Eigen::Matrix3Xd moved = newton_.positions() - scene_.body.mesh.nodes;
    tally_.largest = std::max(tally_.largest, moved.colwise().norm().maxCoeff());
  }

 private:
  const ContactScene& scene_;
  ContactNewton newton_;
  Tally& tally_;
};

// Steps from the start that are not counted.
constexpr int kWarmUp = 100;

bool is_checked(const Options& options, int step) {
  return options.checks > 0 && step >= kWarmUp &&
         step % std::max(1, (options.steps - kWarmUp) / options.checks) == 0;
}

Tally run_cone(const ContactScene& scene, const Options& options) {
  Tally tally(scene.obstacles.empty() ? "free air" : "cone");
  elasticity::SolverOptions solver;
  solver.contact.sweeps = options.sweeps;
  solver.contact.obstacles = scene.obstacles;
  if (options.single) solver.precision = elasticity::Precision::kSingle;
  elasticity::CorotationalQuasistatic model(scene.body, solver);
  model.prepare();
  std::optional<Check> check;  // of contact
  if (!scene.obstacles.empty()) check.emplace(scene, tally);
  elasticity::Refactorisation* job = nullptr;
  int due = 0;
  bool is_cold = false;  // after a check, which has filled the caches
  for (int step = 0; step < options.steps; ++step) {
    const math::Pose hand = scene.hand(step * kContactStep);
    const bool checked = check && is_checked(options, step);
    if (checked) check->before(model.positions(), model.contacts());
    model.hold(0, hand);
    const double begin = thread_time();
    const elasticity::StepReport report = model.step(kContactStep);
    if (job == nullptr) {
      job = model.wanted_refactorisation();
      due = step + options.delay;
    }
    double taken = thread_time() - begin;
    if (job != nullptr && step >= due) {
      job->run();
      const double install = thread_time();
      model.install(*job);
      taken += thread_time() - install;
      job = nullptr;
    }
    int pressing = 0;
    for (const elasticity::SurfaceContact& contact : model.contacts()) {
      pressing += contact.presses();
      tally.deepest = std::max(tally.deepest, -contact.gap);
    }
    if (step >= kWarmUp && !checked && !is_cold) tally.add(taken, pressing, report.iterations);
    if (checked) check->after(hand, model.positions());
    is_cold = checked;
  }
  return tally;
}

Tally run_penalty(const ContactScene& scene, const Options& options) {
  Tally tally("penalty");
  ContactPenalty model(scene, options.penalty);
  Check check(scene, tally);
  bool is_cold = false;
  for (int step = 0; step < options.steps; ++step) {
    const math::Pose hand = scene.hand(step * kContactStep);
    const bool checked = is_checked(options, step);
    if (checked) check.before(model.positions(), model.contacts());
    const double begin = thread_time();
    const elasticity::StepReport report = model.step(hand);
    double taken = thread_time() - begin;
    if (step % options.delay == 0) {  // as often as the model can get a factor
      if (step > 0) {
        model.run();
        const double install = thread_time();
        model.install();
        taken += thread_time() - install;
      }
      model.snapshot();
    }
    tally.deepest = std::max(tally.deepest, model.deepest());
    if (step >= kWarmUp && !checked && !is_cold)
      tally.add(taken, model.pressing(), report.iterations);
    if (checked) check.after(hand, model.positions());
    is_cold = checked;
  }
  return tally;
}

void print(const Tally& tally, std::ostream* csv) {
  std::printf("%-10s %-10s %8s %8s %8s\n", tally.name.c_str(), "points", "steps", "p50 ms",
              "p99 ms");
  const auto line = [&](const std::string& points, const Samples& times) {
    const double p50 = 1e3 * times.quantile(0.5), p99 = 1e3 * times.quantile(0.99);
    std::printf("%-10s %-10s %8zu %8.3f %8.3f\n", "", points.c_str(), times.count(), p50, p99);
    if (csv != nullptr) {
      *csv << tally.name << ',' << points << ',' << times.count() << ',' << p50 << ',' << p99
           << '\n';
    }
  };
  for (const auto& [tens, times] : tally.by_contacts) {
    line(tens == 0 ? "0" : std::to_string(10 * tens - 9) + " to " + std::to_string(10 * tens),
         times);
  }
  line("all", tally.all);
  std::printf("iterations per step %.2f, deepest penetration %.4f mm\n",
              static_cast<double>(tally.iterations) / static_cast<double>(tally.steps),
              1e3 * tally.deepest);
  if (tally.errors.count() == 0) return;
  const double newton = tally.newton.quantile(0.5);
  std::printf(
      "%zu steps compared with Newton's method from the same state (%d not converged): "
      "error of a node, largest, median %.2f um, largest %.2f um (%.3f %% of the largest "
      "displacement)\n",
      tally.errors.count(), tally.not_converged, 1e6 * tally.errors.quantile(0.5),
      1e6 * tally.errors.max(), 100 * tally.errors.max() / tally.largest);
  std::printf(
      "Newton: p50 %.1f ms, %.1f iterations per step; %.0f times the p50 of a step\n\n",
      1e3 * newton,
      static_cast<double>(tally.newton_iterations) / static_cast<double>(tally.errors.count()),
      newton / tally.all.quantile(0.5));
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
  namespace bench = palpate::bench;
  bench::Options options;
  bench::RandomContactOptions random;
  random.steps = 0;
  CLI::App app(
      "Time and accuracy of a step of corotational_quasistatic against the number of contact "
      "points, for two formulations of contact and Newton's method; or, with --random, many steps "
      "among obstacles at random, which ends with 1 if one of them is wrong");
  app.add_option("--steps", options.steps, "Number of steps of 1 ms")
      ->check(CLI::Range(200, 1000000));
  app.add_option("--delay", options.delay, "Steps between a snapshot and its factor");
  app.add_option("--checks", options.checks, "Steps compared with Newton's method");
  app.add_option("--friction", options.friction, "Coulomb friction coefficient of the table");
  app.add_option("--sweeps", options.sweeps, "Gauss-Seidel sweeps per correction");
  app.add_flag("--single", options.single, "Single precision inside elements");
  app.add_option("--stiffness", options.penalty.stiffness, "N/m, of a point of the penalty");
  app.add_option("--slip", options.penalty.slip,
                 "m, slip in a step from which on the penalty's friction is complete");
  app.add_option("--penalty-iterations", options.penalty.iterations,
                 "Largest number of corrections per step of the penalty");
  app.add_option("--csv", options.csv, "File of times by formulation and number of points");
  app.add_option("--random", random.steps, "Number of random steps, instead of the comparison");
  app.add_option("--segment", random.segment_steps, "Random steps before the next model");
  app.add_option("--seed", random.seed, "Of the random steps");
  app.add_option("--first-segment", random.first_segment, "To repeat one of an earlier run");
  if (const auto code = palpate::config::parse(
          app, argc, argv,
          {{{1, "a random step that is not finite, allocates or passes through"}}}))
    return *code;
  if (random.steps > 0) return bench::run_random_contact(random, std::cout) ? 0 : 1;
  std::ofstream csv;
  if (!options.csv.empty()) {
    csv.open(options.csv);
    csv << "formulation,points,steps,p50_ms,p99_ms\n";
  }
  std::ostream* rows = options.csv.empty() ? nullptr : &csv;
  const bench::ContactScene air(false, 0), table(true, options.friction);
  bench::print(bench::run_cone(air, options), rows);
  bench::print(bench::run_cone(table, options), rows);
  bench::print(bench::run_penalty(table, options), rows);
}
