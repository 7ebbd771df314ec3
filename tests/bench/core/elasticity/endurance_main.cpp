#include <CLI/CLI.hpp>
#include <iostream>

#include "rt/config/command_line.hpp"
#include "tests/bench/core/elasticity/endurance.hpp"
#include "tests/bench/core/elasticity/recovery.hpp"

int main(int argc, char** argv) {
  namespace bench = palpate::bench;
  CLI::App app{
      "Many steps of the deformation model under random loads and grasp motions, or, with "
      "--robustness, its way back to rest from wrecked states. Ends with 1 on a number that is not "
      "finite, a leak, or a body that does not come back."};
  bench::EnduranceOptions endurance;
  bench::RecoveryOptions recovery;
  bool robustness = false;
  std::string refactor = "every-10";
  palpate::elasticity::SolverOptions solver;
  app.add_flag("--robustness", robustness, "mirrored and random starts");
  app.add_option("--steps", endurance.steps, "under load, in all")->capture_default_str();
  app.add_option("--segment", endurance.segment_steps, "steps before the next model and modulus")
      ->capture_default_str();
  app.add_option("--first-segment", endurance.first_segment, "to repeat one of an earlier run")
      ->capture_default_str();
  app.add_option("--budget", endurance.budget, "s of thread time that a step may take")
      ->capture_default_str();
  app.add_option("--most-load", endurance.most_load, "times a sensible one")->capture_default_str();
  app.add_option("--young-modulus", recovery.young_modulus, "Pa, of --robustness")
      ->capture_default_str();
  app.add_option("--seconds", recovery.seconds, "simulated, of --robustness, at most")
      ->capture_default_str();
  app.add_option("--damping", recovery.mass_damping, "1/s, by mass, of --robustness")
      ->capture_default_str();
  app.add_option("--only", recovery.only,
                 "of --robustness: lines whose name holds this, e.g. '475 dynamic random'");
  app.add_option("--iterations", solver.iterations, "corrections per step at most")
      ->capture_default_str();
  app.add_option("--refactor", refactor, "background, every-N or never")->capture_default_str();
  app.add_option("--seed", endurance.seed)->capture_default_str();
  if (const auto code =
          palpate::config::parse(app, argc, argv,
                                 {{{1, "a number that is not finite, a leak, or no return to rest"},
                                   {palpate::config::kExitSoftware, "an error"}}}))
    return *code;
  try {
    endurance.refactor = recovery.refactor = bench::RefactorPolicy::parse(refactor);
    endurance.solver = recovery.solver = solver;
    recovery.seed = endurance.seed;
    if (robustness) return bench::run_recoveries(recovery, std::cout) == 0 ? 0 : 1;
    return bench::run_endurance(endurance, std::cout) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "bench_endurance: " << error.what() << '\n';
    return palpate::config::kExitSoftware;
  }
}
