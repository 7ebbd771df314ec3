// Cost of a plug-in: the tick of a pipeline with a control law, an estimator or a deformation model
// of palpate, and of one with the same component as a plug-in (twins.cpp), in pairs of random
// order. Where their memory lies changes a tick by microseconds, so both are constructed several
// times. Prints p50 of each, and the median over these of the median paired difference, with its
// 95 % bootstrap interval, whose upper end may be 1 us.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <random>
#include <stdexcept>

#include "rt/config/command_line.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "tests/support/pipeline_cycles.hpp"
#include "tools/common/bootstrap.hpp"
#include "tools/common/table.hpp"

namespace palpate {
namespace {

constexpr double kPeriod = 1e-3;  // s

class Stopwatch {
 public:
  void start() { begin_ = std::chrono::steady_clock::now(); }
  void stop() { time_ += std::chrono::steady_clock::now() - begin_; }
  double microseconds() const { return std::chrono::duration<double, std::micro>(time_).count(); }

 private:
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::duration time_{};
};

/// The bar of the examples, steered to a target while its hand swings.
class Loop {
 public:
  explicit Loop(const std::vector<std::string>& settings)
      : pipeline_(configuration(settings), kPeriod), signals_(support::at_rest(pipeline_)) {
    rest_W_ = signals_.robot.latest.X_WE.translation();
    const Eigen::Vector3d target(0.25, 0.03, 0.08);  // m
    const char* reason = "";
    pipeline_.start();
    if (!pipeline_.set_target(1, "point", nullptr, 0, target.data(), 3, reason))
      throw std::runtime_error(reason);
  }

  /// us of a cycle, without the factorisation, which is made in another thread.
  double tick(int cycle) {
    constexpr double kSwing = 5e-3, kRate = 2;  // m, rad/s
    signals_.robot.latest.X_WE.translation() =
        rest_W_ + Eigen::Vector3d(0, 0, kSwing * std::sin(kRate * kPeriod * cycle));
    Stopwatch watch;
    watch.start();
    pipeline_.sense(signals_, signals_);
    pipeline_.distribute();
    watch.stop();
    while (elasticity::Refactorisation* job = pipeline_.model().wanted_refactorisation()) {
      job->run();
      pipeline_.model().install(*job);
    }
    watch.start();
    pipeline_.estimate(kPeriod);
    pipeline_.evaluate_feature();
    pipeline_.control(kPeriod);
    pipeline_.gate(kPeriod);
    watch.stop();
    return watch.microseconds();
  }

  math::Vector6d command() const { return pipeline_.gate_output(0).V_W_E.vector(); }

 private:
  static config::Node configuration(std::vector<std::string> settings) {
    settings.insert(settings.begin(), {"plugins=[{library: twins.so}]", "sensing=[]"});
    return config::Node::load_file(
        std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml", settings);
  }

  pipeline::Pipeline pipeline_;
  sensing::Signals signals_;
  Eigen::Vector3d rest_W_;
};

struct Cost {
  double built_in, plug_in;  // us, p50 of a tick
  common::Interval95 difference;
};

struct Ticks {
  std::vector<double> direct, guarded, difference;  // us
};

/// Throws std::runtime_error if the commands differ: then it is not the same component.
Ticks measure(Loop& own, Loop& plugged, int pairs, std::mt19937& random) {
  constexpr int kSettled = 200;  // cycles
  Ticks ticks;
  for (int i = -kSettled; i < pairs; ++i) {
    const bool first = random() % 2 == 0;
    double by_plugin = first ? plugged.tick(i) : 0;
    const double by_built_in = own.tick(i);
    if (!first) by_plugin = plugged.tick(i);
    if (!((own.command() - plugged.command()).norm() <= 1e-12))
      throw std::runtime_error("the plug-in commands something else than the built-in component");
    if (i < 0) continue;
    ticks.direct.push_back(by_built_in);
    ticks.guarded.push_back(by_plugin);
    ticks.difference.push_back(by_plugin - by_built_in);
  }
  if (own.command().norm() == 0) throw std::runtime_error("nothing is steered");
  return ticks;
}

Cost compare(int pairs, int layouts, const std::vector<std::string>& built_in,
             const std::vector<std::string>& plug_in) {
  std::mt19937 random(1);
  std::vector<double> direct, guarded, difference;
  std::vector<std::vector<char>> ballast;  // moves what is allocated after it
  for (int i = 0; i < layouts; ++i) {
    ballast.emplace_back(1 + random() % 100'000);
    const bool first = random() % 2 == 0;
    Loop one(first ? plug_in : built_in);
    ballast.emplace_back(1 + random() % 100'000);
    Loop other(first ? built_in : plug_in);
    const Ticks ticks =
        measure(first ? other : one, first ? one : other, std::max(1, pairs / layouts), random);
    direct.insert(direct.end(), ticks.direct.begin(), ticks.direct.end());
    guarded.insert(guarded.end(), ticks.guarded.begin(), ticks.guarded.end());
    difference.push_back(common::median_of(ticks.difference).value);
  }
  return {common::median_of(direct).value, common::median_of(guarded).value,
          common::median_of(difference)};
}

/// False if a component costs more than `limit` us.
bool run(int pairs, int layouts, double limit) {
  struct Row {
    const char* name;
    std::vector<std::string> built_in, plug_in;
  };
  const Row rows[] = {
      {"control law proportional_twist",
       {"control={provider: fem, law: proportional_twist}"},
       {"control={provider: fem, law: twin_law}"}},
      {"estimator pose_driven",
       {"estimation={component: pose_driven}"},
       {"estimation={component: twin_estimator}"}},
      {"deformation model linear",
       {"deformation={component: linear}"},
       {"deformation={component: twin_model}"}},
  };
  common::Table table({"component", "p50 built in us", "p50 plug-in us", "paired difference us",
                       "95 % interval us", "limit us", ""});
  bool met = true;
  for (const Row& row : rows) {
    const Cost cost = compare(pairs, layouts, row.built_in, row.plug_in);
    const bool good = cost.difference.high <= limit;
    met = met && good;
    table.add(
        {row.name, common::number(cost.built_in, 2), common::number(cost.plug_in, 2),
         common::number(cost.difference.value, 3),
         common::number(cost.difference.low, 3) + " to " + common::number(cost.difference.high, 3),
         common::number(limit, 1), good ? "met" : "MISSED"});
  }
  table.print(std::cout);
  std::cout << pairs << " pairs of ticks of each, in " << layouts
            << " constructions; bootstrap of the median of their differences over constructions\n";
  return met;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  int pairs = 20000, layouts = 20;
  double limit = 1;
  CLI::App app("Cost of a plugged-in law, estimator and model compared with the same built in.");
  app.add_option("pairs", pairs, "number of pairs of ticks")->check(CLI::Range(2, 10000000));
  app.add_option("--layouts", layouts, "number of constructions, each elsewhere in memory")
      ->check(CLI::Range(2, 10000));
  app.add_option("--limit", limit, "us, upper end of the interval above which it ends with 1");
  if (const auto code = palpate::config::parse(app, argc, argv)) return *code;
  try {
    return palpate::run(pairs, layouts, limit) ? 0 : palpate::config::kExitError;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return palpate::config::kExitError;
  }
}
