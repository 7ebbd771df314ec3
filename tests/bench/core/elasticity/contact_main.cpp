// Time of a step against the number of points in contact: the quadratic bar of 475 nodes slides on
// a table that its hand presses it onto, with factors computed outside the loop, and the same
// motion in free air. Thread time, so that other processes count for less.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <map>

#include "core/elasticity/corotational_model.hpp"
#include "rt/config/command_line.hpp"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

double thread_time() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<long>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Options {
  int steps = 4000;
  int delay = 20;  // steps between a snapshot and its factor
  double friction = 0.3;
  int sweeps = elasticity::ContactOptions().sweeps;
  bool table = true;
};

/// Bar fixed at x = 0, whose other end a hand lowers below the table's height at the middle, turns
/// and slides along and across.
void run(const Options& options) {
  elasticity::Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box({0.2, 0.05, 0.05}, {9, 2, 2}),
                                      mesh::ElementOrder::kQuadratic);
  body.material = {1e5, 0.35, 300};
  body.gravity_O = {0, 0, -9.81};
  elasticity::GraspRegion grasp;
  for (int n = 0; n < body.mesh.node_count(); ++n) {
    if (body.mesh.nodes(0, n) > 0.2 - 1e-9) grasp.nodes.push_back(n);
    if (body.mesh.nodes(0, n) < 1e-9) body.fixed_nodes.push_back(n);
  }
  grasp.X_OG_rest.translation() = Vector3d(0.2, 0.025, 0.025);
  body.grasps = {grasp};
  elasticity::SolverOptions solver;
  solver.contact.sweeps = options.sweeps;
  if (options.table) {
    // ends short of the hand, which holds the bar above it
    solver.contact.obstacles = {
        {"table", collision::Box{{0.09, 0.2, 0.1}},
         math::make_pose(Eigen::Matrix3d::Identity(), {0.09, 0.025, -0.102}), options.friction}};
  }
  elasticity::CorotationalQuasistatic model(body, solver);
  model.prepare();
  elasticity::Refactorisation* job = nullptr;
  int due = 0, iterations = 0;
  double deepest = 0;
  std::map<int, std::vector<double>> by_contacts;  // s, by tens of points under force
  std::vector<double> all;
  for (int step = 0; step < options.steps; ++step) {
    const double t = step * 1e-3, press = 0.5 * (1 - std::cos(2 * t));
    math::Pose hand = grasp.X_OG_rest;
    hand.translation() += press * Vector3d(-0.006, 0.008 * std::sin(3 * t), -0.0018);
    hand.linear() = math::exp_rotation({0, -0.25 * press, 0.05 * std::sin(3 * t)});
    model.hold(0, hand);
    const double begin = thread_time();
    const elasticity::StepReport report = model.step(1e-3);
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
    iterations += report.iterations;
    int pressing = 0;
    for (const elasticity::SurfaceContact& contact : model.contacts()) {
      pressing += contact.presses();
      deepest = std::max(deepest, -contact.gap);
    }
    if (step < 100) continue;
    by_contacts[(pressing + 9) / 10].push_back(taken);
    all.push_back(taken);
  }
  std::printf("%-10s %8s %8s %8s\n", options.table ? "points" : "free air", "steps", "p50 ms",
              "p99 ms");
  const auto line = [](const std::string& name, const std::vector<double>& times) {
    std::printf("%-10s %8zu %8.3f %8.3f\n", name.c_str(), times.size(), 1e3 * quantile(times, 0.5),
                1e3 * quantile(times, 0.99));
  };
  for (const auto& [tens, times] : by_contacts) {
    line(tens == 0 ? "0" : std::to_string(10 * tens - 9) + " to " + std::to_string(10 * tens),
         times);
  }
  line("all", all);
  std::printf("iterations per step %.2f, deepest penetration %.4f mm\n",
              static_cast<double>(iterations) / options.steps, 1e3 * deepest);
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
  palpate::bench::Options options;
  CLI::App app("Time of a step of corotational_quasistatic against the number of contact points");
  app.add_option("--steps", options.steps, "Number of steps of 1 ms");
  app.add_option("--delay", options.delay, "Steps between a snapshot and its factor");
  app.add_option("--friction", options.friction, "Coulomb friction coefficient of the table");
  app.add_option("--sweeps", options.sweeps, "Gauss-Seidel sweeps per correction");
  if (const auto code = palpate::config::parse(app, argc, argv)) return *code;
  for (const bool table : {false, true}) {
    options.table = table;
    palpate::bench::run(options);
  }
}
