// palpate-evaluate: runs, records and scores palpate. See --help.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "rt/config/command_line.hpp"
#include "rt/config/installation.hpp"
#include "rt/config/node.hpp"
#include "tools/common/interruption.hpp"
#include "tools/lab/cases/case_commands.hpp"
#include "tools/lab/demo/demo.hpp"
#include "tools/lab/endurance/cycle_cost.hpp"
#include "tools/lab/endurance/latency.hpp"
#include "tools/lab/endurance/soak.hpp"
#include "tools/lab/faults/faults.hpp"
#include "tools/lab/scores/score.hpp"
#include "tools/lab/sensor_models/emulated_tactile.hpp"
#include "tools/lab/sensor_models/observer.hpp"
#include "tools/lab/sensor_models/sensors.hpp"
#include "tools/lab/sensor_models/tactile.hpp"
#include "tools/lab/shapes/shapes_command.hpp"
#include "tools/lab/studies/discrepancies.hpp"
#include "tools/lab/studies/sensing_training.hpp"
#include "tools/lab/studies/study.hpp"
#include "tools/lab/studies/study_reference.hpp"
#include "tools/lab/uncertainty/draws_command.hpp"

namespace {

using namespace palpate::cases;
using namespace palpate::demo;
using namespace palpate::endurance;
using namespace palpate::faults;
using namespace palpate::scores;
using namespace palpate::sensor_models;
using namespace palpate::shapes;
using namespace palpate::studies;
using namespace palpate::uncertainty;

std::string default_data(const std::string& root) {
  if (const char* folder = std::getenv("PALPATE_DATA")) return folder;
  return root + "/../shared/data";
}

int run(CLI::App& app, int argc, char** argv) {
  std::string root = palpate::config::data_folder().string();
  std::string json;
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  palpate-evaluate demo --output out/demo\n"
      "  palpate-evaluate thesis --quick --output out/thesis");
  app.add_option("--root", root, "folder with scenes and configurations (default: palpate's own)");
  app.fallthrough();

  DemoOptions demo;
  std::string data;
  CLI::App* demo_command = app.add_subcommand(
      "demo",
      "run of simulator and daemon through the applications of the thesis; table, plots, pictures");
  demo_command->add_option("--output", demo.output, "folder of all output")->required();
  demo_command->add_option("--data", data, "recordings (default: PALPATE_DATA or ../shared/data)");
  demo_command->add_option("--stages", demo.stages, "stages to run")
      ->check(CLI::IsMember({"sensing", "control", "recording"}))
      ->capture_default_str();
  demo_command
      ->add_option("--scene-set", demo.scene_overrides,
                   "key of every scene to override: path.to.key=value (repeatable)")
      ->allow_extra_args(false);
  demo_command
      ->add_option("--daemon-set", demo.daemon_overrides,
                   "key of palpated to override (repeatable)")
      ->allow_extra_args(false);
  demo_command->add_option("--json", json, "write the summary to this file too");

  SoakOptions soak;
  soak.output = "out/soak";
  CLI::App* soak_command =
      app.add_subcommand("soak",
                         "daemon with simulator for long: memory, overruns, latency; or, in "
                         "virtual time, hours under a random mix of faults");
  soak_command->add_option("--minutes", soak.minutes)
      ->check(CLI::Range(0.5, 1e4))
      ->capture_default_str();
  bool virtual_soak = false;
  soak_command->add_flag("--virtual", virtual_soak,
                         "in virtual time, with one fault after another at random; minutes are "
                         "virtual too, about fourteen of them a minute");
  soak_command->add_option("--seed", soak.seed, "seed of the faults in virtual time")
      ->capture_default_str();
  soak_command->add_option("--output", soak.output, "folder for what the programs print")
      ->capture_default_str();
  soak_command->add_option("--json", json, "write the result to this file");

  LatencyOptions latency;
  latency.output = "out/latency";
  bool unstressed = false;
  CLI::App* latency_command = app.add_subcommand(
      "latency",
      "the loop's wake-up and cycle compared with cyclictest in the same minute, with and without "
      "stress-ng");
  latency_command->add_option("--seconds", latency.seconds, "duration of each of the two runs")
      ->check(CLI::Range(5.0, 1e5))
      ->capture_default_str();
  latency_command->add_flag("--no-stress", unstressed, "no run under stress");
  latency_command
      ->add_option("--daemon-set", latency.overrides, "key of palpated to override (repeatable)")
      ->allow_extra_args(false);
  latency_command->add_option("--output", latency.output, "folder for picture and outputs")
      ->capture_default_str();
  latency_command->add_option("--json", json, "write the result to this file");

  CycleCostOptions cost;
  CLI::App* cost_command = app.add_subcommand(
      "cost",
      "processor time of estimator, Jacobian and quadratic program in a cycle, for objects of 150 "
      "to 700 nodes with every limit; exit code 1 where any of it allocates memory");
  cost_command->add_option("--cycles", cost.cycles, "number of cycles for each object")
      ->check(CLI::Range(100, 10'000'000))
      ->capture_default_str();
  cost_command
      ->add_option("--daemon-set", cost.overrides,
                   "key of rt/config/examples/bar_long_soft_limits.yaml to override (repeatable)")
      ->allow_extra_args(false);
  cost_command->add_option("--json", json, "write the result to this file");

  ScoreOptions score;
  CLI::App* score_command =
      app.add_subcommand("score", "score of recorded logs of a simulated run");
  score_command->add_option("--control", score.control, "log of the control URL")
      ->required()
      ->check(CLI::ExistingFile);
  score_command->add_option("--housekeeping", score.housekeeping, "log of the housekeeping URL")
      ->required()
      ->check(CLI::ExistingFile);
  score_command->add_option("--scene", score.scene, "scene: its poses must all have been held")
      ->check(CLI::ExistingFile);
  score_command
      ->add_option("--config", score.configuration,
                   "configuration of palpated: commands are checked against its gate")
      ->check(CLI::ExistingFile);
  score_command->add_option("--json", json, "write the result to this file");

  TactileOptions tactile;
  CLI::App* tactile_command = app.add_subcommand(
      "tactile", "linear force map fitted to a BioTac; errors of force and contact point");
  tactile_command->add_option("--data", data, "recordings (default as for demo)");
  tactile_command->add_option("--model", tactile.model, "write the fitted map for biotac_linear");
  tactile_command->add_option("--json", json, "write the result to this file");
  bool emulated = false;
  tactile_command->add_flag("--emulated", emulated,
                            "fit the simulator's BioTac on random presses instead of a recording");

  SensorsCommand sensors(app);
  ObserverCommand observer(app);

  StudyCommand thesis(app,
                      {"thesis", "the applications of the thesis",
                       "the applications of the thesis with every method, model error and seed",
                       "tools/lab/studies/thesis.yaml", "out/thesis"});
  StudyCommand estimate(app, {"estimate", "estimators of the shape, blind and with observations",
                              "every estimator on bars and blocks under model errors: each object "
                              "is simulated once for each of them and seed, and every method is "
                              "run on that recording",
                              "tools/lab/studies/estimate.yaml", "out/estimate", true});
  StudyCommand control(
      app, {"control", "shape control, blind and with observations",
            "controllers on points far from the hand, limits and drop-outs under the grid of model "
            "errors",
            "tools/lab/studies/control.yaml", "out/control"});
  StudyCommand published_sensing(
      app, {"published-sensing", "the published sensing methods on one plant before a camera",
            "the sensing methods of the thesis' Table 2.1 on one plant before a camera, compared "
            "with palpate's own: each task is simulated once for each level of vision and seed, "
            "and every method is run on that recording",
            "tools/lab/studies/published_sensing.yaml", "out/published-sensing", true});

  DiscrepanciesCommand discrepancies(app);

  TrainSensingCommand train_sensing(app);

  StudyReferenceCommand reference(app);
  DrawsCommand draws(app);

  FaultsCommand faults(app);

  CaseCommands cases(app);
  ShapesCommand shapes(app);

  if (const auto code =
          palpate::config::parse(app, argc, argv,
                                 {{{0, "all passed"},
                                   {1, "an error, or a run failed or missed its figure"},
                                   {78, "wrong configuration"},
                                   {palpate::config::kExitInterrupted, "interrupted"}},
                                  {{"--out", "--output"}}}))
    return *code;
  if (data.empty()) data = default_data(root);
  if (const auto code = cases.run(data, std::cout)) return *code;
  if (const auto code = shapes.run(default_data(root), std::cout)) return *code;
  if (const auto code = sensors.run(default_data(root), std::cout)) return *code;
  if (const auto code = observer.run(root, std::cout)) return *code;
  for (StudyCommand* study : {&thesis, &estimate, &control, &published_sensing})
    if (const auto code = study->run(root, std::cout)) return *code;
  if (const auto code = reference.run(root, std::cout)) return *code;
  if (const auto code = draws.run(root, std::cout)) return *code;
  if (const auto code = discrepancies.run(root, std::cout)) return *code;
  if (const auto code = train_sensing.run(root, std::cout)) return *code;
  if (const auto code = faults.run(std::cout)) return *code;
  if (demo_command->parsed()) {
    demo.root = root;
    demo.data = data;
    demo.json = json;
    return run_demo(demo);
  }
  if (soak_command->parsed()) {
    soak.root = root;
    soak.json = json;
    return virtual_soak ? run_virtual_soak(soak) : run_soak(soak);
  }
  if (latency_command->parsed()) {
    latency.root = root;
    latency.json = json;
    latency.stressed = !unstressed;
    return run_latency(latency);
  }
  if (cost_command->parsed()) {
    cost.root = root;
    cost.json = json;
    return run_cycle_cost(cost, std::cout);
  }
  if (tactile_command->parsed()) {
    if (emulated) return run_emulated_tactile(tactile.model, std::cout);
    tactile.data = data;
    tactile.json = json;
    return run_tactile(tactile, std::cout);
  }
  score.json = json;
  return run_score(score);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "palpate-evaluate runs palpated against the simulator or a recording and scores it on the "
      "truth.");
  try {
    return run(app, argc, argv);
  } catch (const palpate::common::Interrupted&) {
    std::fprintf(stderr, "\ninterrupted; every program has been stopped\n");
    return palpate::config::kExitInterrupted;
  } catch (const palpate::config::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return palpate::config::kExitCode;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
