#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "rt/config/command_line.hpp"
#include "rt/config/node.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/fit_check/coverage.hpp"
#include "tools/lab/fit_check/simulated.hpp"

namespace {

using namespace palpate;
using common::number;

constexpr double kLeastCoverage = 0.90, kMostCoverage = 0.99;

/// Below the system's folder for temporary files; here if it has none.
std::string default_folder() {
  std::error_code error;
  const std::filesystem::path temporary = std::filesystem::temp_directory_path(error);
  return ((error ? "." : temporary) / "palpate_fit_check").string();
}

struct Options {
  std::string folder = default_folder();
  int seeds = 200;
  std::vector<std::string> overrides;
  std::string cells = fit_check::StatementOptions().cells;
  std::string json;
};

int run_coverage(const Options& options) {
  nlohmann::json json = nlohmann::json::array();
  common::Table table({"own model", "parameter", "fits", "truth inside", "mean width"});
  const std::vector<fit_check::OwnModel> models = fit_check::own_models(options.folder);
  bool is_met = true;
  for (std::size_t k = 0; k < models.size(); ++k) {
    common::Progress progress(static_cast<int>(k) + 1, static_cast<int>(models.size()),
                              models[k].mechanics->name());
    const auto rows = fit_check::measure_coverage(models[k].mechanics, models[k].truth,
                                                  options.seeds, [&](double share) {
                                                    common::throw_if_interrupted();
                                                    progress.show(share, "");
                                                  });
    progress.finish(true);
    for (const fit_check::Coverage& row : rows) {
      is_met = is_met && row.share() >= kLeastCoverage && row.share() <= kMostCoverage;
      table.add({row.experiment, row.parameter, std::to_string(row.seeds),
                 number(100 * row.share(), 1) + " %", number(100 * row.mean_width, 2) + " %"});
      json.push_back({{"experiment", row.experiment},
                      {"parameter", row.parameter},
                      {"fits", row.seeds},
                      {"share", row.share()},
                      {"mean_width", row.mean_width}});
    }
  }
  table.print(std::cout);
  std::cout << "To be met: the 95 % interval holds the truth in 90 to 99 % of the fits: "
            << (is_met ? "met\n" : "missed\n");
  if (!options.json.empty()) common::write_json(json, options.json);
  return is_met ? 0 : 1;
}

int run_simulated(const Options& options) {
  common::Progress progress(1, 1, "simulated bar");
  fit_check::StatementOptions plan;
  plan.folder = options.folder;
  plan.overrides = options.overrides;
  plan.cells = options.cells;
  plan.progress = [&](const std::string& what, double share) {
    common::throw_if_interrupted();
    progress.show(share, what);
  };
  const std::vector<fit_check::Statement> statements = fit_check::fit_simulated(plan);
  progress.finish(true);
  common::Table table({"parameter", "truth", "found", "95 % interval", "error", "at most"});
  nlohmann::json json = nlohmann::json::array();
  bool is_met = true;
  for (const fit_check::Statement& s : statements) {
    is_met = is_met && s.is_met();
    table.add({s.parameter, number(s.truth, 4), number(s.found, 4),
               number(s.low, 4) + " to " + number(s.high, 4), number(s.error, 4),
               number(s.bar, 2) + (s.is_met() ? "" : " missed")});
    json.push_back({{"parameter", s.parameter},
                    {"truth", s.truth},
                    {"found", s.found},
                    {"interval", {s.low, s.high}},
                    {"error", s.error},
                    {"at_most", s.bar}});
  }
  table.print(std::cout);
  std::cout << "Errors are relative, that of poisson_ratio absolute.\n";
  if (!options.json.empty()) common::write_json(json, options.json);
  return is_met ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Holds palpate-fit against what is known: recordings of the simulator, whose plant is "
      "another "
      "model on another mesh, and recordings made by the fitted models themselves.");
  app.footer(
      "Example:\n"
      "  palpate-fit-check simulated --json results.json");
  app.require_subcommand(1);
  app.add_option("--folder", options.folder, "For recordings")->capture_default_str();
  app.add_option("--json", options.json, "File for the results");
  CLI::App* simulated =
      app.add_subcommand("simulated", "E, nu and damping of the simulator's bar, 1 % noise");
  simulated->add_option("--set", options.overrides, "path.to.key=value over the scenes'");
  simulated->add_option("--cells", options.cells, "Of the mesh that is fitted")
      ->capture_default_str();
  CLI::App* coverage = app.add_subcommand(
      "coverage", "How often 95 % intervals hold the truth of recordings by the own model");
  coverage->add_option("--seeds", options.seeds, "Recordings of each")->capture_default_str();
  if (const auto code = config::parse(
          app, argc, argv,
          {{{0, "met"}, {1, "missed or an error"}, {78, "wrong scene"}, {130, "interrupted"}}}))
    return *code;
  common::catch_interruptions();
  try {
    std::filesystem::create_directories(options.folder);
    return coverage->parsed() ? run_coverage(options) : run_simulated(options);
  } catch (const common::Interrupted&) {
    std::cerr << "palpate-fit-check: interrupted\n";
    return config::kExitInterrupted;
  } catch (const config::Error& error) {
    std::cerr << "palpate-fit-check: " << error.what() << "\n";
    return config::kExitCode;
  } catch (const std::exception& error) {
    std::cerr << "palpate-fit-check: " << error.what() << "\n";
    return 1;
  }
}
