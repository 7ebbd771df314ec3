#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "rt/config/command_line.hpp"
#include "rt/config/installation.hpp"
#include "rt/config/node.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/program.hpp"
#include "tools/common/progress.hpp"
#include "tools/fit/held/held_plan_report.hpp"
#include "tools/fit/kinds.hpp"
#include "tools/fit/report.hpp"
#include "tools/fit/simulators/simulator_files.hpp"

namespace {

using namespace palpate;

struct Options {
  std::string plan;
  std::string data = ".";
  std::string out;
  std::string json;
  std::vector<std::string> overrides;
  bool details = false;
  bool resume = false;
  bool check_gradients = false;
  bool numeric = false;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

std::filesystem::path presets() { return config::data_folder() / "tools/fit/presets"; }

/// A file, or the name of a plan supplied with palpate.
std::string plan_path(const std::string& text) {
  if (std::filesystem::is_regular_file(text)) return text;
  const std::filesystem::path preset = presets() / (text + ".yaml");
  if (std::filesystem::exists(preset)) return preset.string();
  throw config::Error(text + ": is neither a file nor a preset");
}

/// For --help: the kinds of recordings, and the supplied plans.
std::string footer() {
  std::string text =
      "A plan names recordings (CSV or CSV.gz with units) and what is free:\n"
      "  name: foam\n"
      "  recording: {kind: uniaxial, model: hyperfoam_1, direction: compression, contact_offset: "
      "free}\n"
      "  recordings:\n"
      "    - file: press.csv\n"
      "      columns: {displacement: {name: u_mm, unit: mm}, force: {name: F, unit: N, sign: -1}}\n"
      "      geometry: {length: 20 mm, diameter: 30 mm}\n"
      "      held_out: {quantity: strain, from: 0.3}\n"
      "  parameters: {young_modulus: {start: 3e4}}\n"
      "  solver: {loss: huber, loss_scale: 2, starts: 4, seed: 1, profile: auto}\n\nKinds:\n";
  for (const fit::Kind& kind : fit::kinds()) text += "  " + kind.name + ": " + kind.summary + "\n";
  text += "\nPresets:";
  std::vector<std::string> names;
  if (std::filesystem::exists(presets()))
    for (const auto& entry : std::filesystem::directory_iterator(presets()))
      names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) text += " " + name;
  return text +
         "\n\nExample:\n  palpate-fit foam.yaml --data recordings --output out/foam --details";
}

std::vector<fit::JobResult> run_with_progress(const fit::Plan& plan, const Options& options) {
  fit::RunOptions run;
  run.data = options.data;
  if (!options.out.empty()) {
    std::filesystem::create_directories(options.out);
    run.checkpoint = std::filesystem::path(options.out) / "checkpoint.json";
  }
  run.resumes = options.resume;
  run.checks_gradients = options.check_gradients;
  run.compares_numeric = options.numeric;
  run.threads = options.threads;
  common::Progress progress(1, 1, plan.name);
  run.progress = [&](double fraction, const std::string& note) { progress.show(fraction, note); };
  std::vector<fit::JobResult> results = fit::run(plan, run);
  progress.finish(true, std::to_string(results.size()) + (results.size() == 1 ? " fit" : " fits"));
  return results;
}

std::string report_with_progress(const nlohmann::json& json, const Options& options) {
  if (options.out.empty()) return fit::make_report(json, {}, options.details);
  common::Progress progress(1, 1, "tables and pictures");
  std::string text = fit::make_report(json, options.out, options.details);
  progress.finish(true, options.out);
  return text;
}

int run(const Options& options) {
  if (options.resume && options.out.empty())
    throw config::Error("--resume needs --output, where the checkpoint lies");
  const fit::Plan plan = fit::read_plan(
      config::Node::load_file(plan_path(options.plan), options.overrides), options.data);
  const std::vector<fit::JobResult> results = run_with_progress(plan, options);
  // With JSON, nothing else may be written to the standard output.
  std::ostream& out = options.json == "-" ? std::cerr : std::cout;
  const nlohmann::json json = fit::to_json(plan, results);
  if (!options.json.empty()) common::write_json(json, options.json);
  if (!options.out.empty()) fit::write_materials(plan, results, options.out);
  const bool is_good =
      fit::print_failures(plan, results, std::cerr) && !fit::has_wrong_gradient(results);
  out << report_with_progress(json, options);
  return is_good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Finds material parameters from recordings, with intervals: bars in tension and compression, "
      "balls pressed in, and more.");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.footer(footer());
  app.add_option("fits", options.plan, "YAML file of a plan, or a preset");
  app.add_option("--data", options.data, "Folder that the plan's files lie below")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  app.add_option("-o,--output", options.out,
                 "Folder for material.yaml, samples.csv, fit.png, fits.csv and fits.json, and the "
                 "checkpoint");
  app.add_option("--json", options.json, "File for all results as JSON; - for the standard output");
  app.add_option("--set", options.overrides, "path.to.key=value over the plan's");
  app.add_flag("--details", options.details,
               "Every fit's parameters, series and what is undetermined");
  app.add_flag("--resume", options.resume, "Continue from the checkpoint in --output");
  app.add_flag("--check-gradients", options.check_gradients,
               "Compare derivatives with Ridders' differences; above 1e-6 is an error");
  app.add_flag("--numeric", options.numeric,
               "Search by differences too: evaluations and time as ratios");
  app.add_option("--threads", options.threads, "Fits (of one: recordings) worked on at once")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  int code = 0;
  fit::add_held_plan_command(app, code);
  fit::add_export_command(app, code);
  common::catch_interruptions();
  return common::run_program("palpate-fit", [&]() -> int {
    if (const auto ended = config::parse(app, argc, argv,
                                         {{{1, "an error, a fit that failed, or wrong derivatives"},
                                           {78, "wrong plan"},
                                           {config::kExitInterrupted, "interrupted"}},
                                          {{"--out", "--output"}}}))
      return *ended;
    if (!app.get_subcommands().empty()) return code;
    if (options.plan.empty()) return config::usage_error(app, "a plan or a command is required");
    return run(options);
  });
}
