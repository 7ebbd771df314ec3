// Cost of one solve: p50 and p99 over the cycles of servo loops, each of whose programs is the
// previous one with g and the bounds changed by a thousandth; cold, warm, and compared with R's
// quadprog on the same programs if that is installed.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <iostream>

#include "tests/bench/core/math/quadprog_peer.hpp"
#include "tests/support/quadratic_programs/random_programs.hpp"

namespace palpate::bench {
namespace {

using math::QuadraticProgram;
using math::QuadraticProgramSolver;
using support::Family;

constexpr int kLoops = 20;
constexpr int kCycles = 50;
constexpr double kDrift = 1e-3;

/// Loops with exactly this many variables, one after the other.
std::vector<QuadraticProgram> cycles(Family family, int variables, int rows) {
  math::Random random(1, support::name(family));
  std::vector<QuadraticProgram> programs;
  for (int loop = 0; loop < kLoops; ++loop) {
    QuadraticProgram program(1);
    do {
      program = support::random_program(family, variables, rows, random);
    } while (program.variables() != variables || program.rows() < rows / 2);
    for (int cycle = 0; cycle < kCycles; ++cycle) {
      programs.push_back(program);
      support::drift(program, kDrift, random);
    }
  }
  return programs;
}

/// Times of single solves, us; `prepare` is not timed.
template <class Prepare, class Solve>
void measure(benchmark::State& state, const std::vector<QuadraticProgram>& programs,
             Prepare&& prepare, Solve&& solve) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  times.reserve(1 << 20);
  std::size_t next = 0;
  for (auto _ : state) {
    const QuadraticProgram& program = programs[next++ % programs.size()];
    prepare(program);
    const auto before = Clock::now();
    benchmark::DoNotOptimize(solve(program));
    const double seconds = std::chrono::duration<double>(Clock::now() - before).count();
    state.SetIterationTime(seconds);
    if (times.size() < times.capacity()) times.push_back(1e6 * seconds);
  }
  std::sort(times.begin(), times.end());
  state.counters["p50_us"] = times[times.size() / 2];
  state.counters["p99_us"] = times[times.size() * 99 / 100];
}

void register_size(Family family, int variables, int rows, QuadprogPeer* peer) {
  const std::string size = "/" + std::to_string(variables) + "x" + std::to_string(rows);
  const auto add = [&](const std::string& how, auto&& run) {
    benchmark::RegisterBenchmark((support::name(family) + size + "/" + how).c_str(), run)
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
  };
  const auto ours = [=](benchmark::State& state, QuadraticProgramSolver::Start start) {
    const auto programs = cycles(family, variables, rows);
    QuadraticProgramSolver solver;
    double iterations = 0;
    measure(
        state, programs, [](const QuadraticProgram&) {},
        [&](const QuadraticProgram& program) {
          const auto status = solver.solve(program, start);
          iterations += solver.iterations();
          return status;
        });
    state.counters["iterations"] = iterations / static_cast<double>(state.iterations());
  };
  add("cold", [=](benchmark::State& s) { ours(s, QuadraticProgramSolver::Start::kCold); });
  add("warm", [=](benchmark::State& s) { ours(s, QuadraticProgramSolver::Start::kWarm); });
  // It has no soft rows, and treats rows that intersect in a point as contradictory.
  if (!peer || family == Family::kSoft || family == Family::kVertex) return;
  add("quadprog", [=](benchmark::State& state) {
    const auto programs = cycles(family, variables, rows);
    QuadraticProgramSolver solver;
    solver.solve(programs[0]);
    peer->load(programs[0]);
    if (!peer->solve()) {
      state.SkipWithError("it finds no answer");
    } else if ((peer->u() - solver.u()).norm() > 1e-6 * solver.u().norm()) {
      state.SkipWithError("the answers differ");
    }
    measure(
        state, programs, [peer](const QuadraticProgram& program) { peer->load(program); },
        [peer](const QuadraticProgram&) { return peer->solve(); });
  });
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
  const auto peer = palpate::bench::QuadprogPeer::open();
  if (!peer) std::cerr << "r-cran-quadprog is not installed: no figures to compare with\n";
  for (const auto family : {palpate::support::Family::kBox, palpate::support::Family::kPlain,
                            palpate::support::Family::kVertex, palpate::support::Family::kSoft}) {
    palpate::bench::register_size(family, 6, 40, peer.get());
    palpate::bench::register_size(family, 14, 80, peer.get());
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
