#include "tools/lab/faults/faults.hpp"

#include <fstream>
#include <stdexcept>
#include <thread>

#include "tools/common/progress.hpp"
#include "tools/lab/faults/faults_process.hpp"
#include "tools/lab/faults/faults_report.hpp"

namespace palpate::faults {

struct FaultsCommand::Options {
  int seeds = 100;
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::uint64_t first_seed = 1;
  std::vector<std::string> rows;
  bool process = false;
  std::filesystem::path json, output;
};

FaultsCommand::FaultsCommand(CLI::App& app)
    : options_(std::make_unique<Options>()),
      command_(app.add_subcommand(
          "faults", "injects faults, in virtual time or into processes; what became of each")) {
  command_->add_flag("--process", options_->process,
                     "done to palpated itself over LCM and in real time, on ports of its own");
  command_->add_option("--seeds", options_->seeds, "of each row")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command_->add_option("--first-seed", options_->first_seed, "to run a seed once more")
      ->capture_default_str();
  command_->add_option("--rows", options_->rows, "numbers of rows, as 1,2,5 (default: all)")
      ->delimiter(',');
  command_->add_option("--jobs", options_->jobs, "processes at a time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command_->add_option("--json", options_->json, "write the table to this file too");
  command_->add_option("--output", options_->output, "folder for faults.csv and faults.png");
}

FaultsCommand::~FaultsCommand() = default;

std::optional<int> FaultsCommand::run(std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& options = *options_;
  const std::vector<faults::Row> rows =
      options.process ? choose_process_rows(options.rows) : faults::choose_rows(options.rows);
  const faults::Bench bench = faults::make_bench();
  std::vector<faults::RowReport> reports;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    common::Progress progress(static_cast<int>(i) + 1, static_cast<int>(rows.size()),
                              rows[i].number + " " + rows[i].fault);
    reports.push_back(faults::run_row(
        bench, rows[i], options.seeds, options.jobs,
        [&](int done) { progress.show(static_cast<double>(done) / options.seeds); },
        options.first_seed));
    progress.finish(reports.back().met(), name(reports.back().worst()));
  }
  print_faults(reports, out);
  if (!options.json.empty()) {
    std::ofstream file(options.json);
    file << faults_json(reports).dump(2) << '\n';
    if (!file) throw std::runtime_error("cannot write " + options.json.string());
  }
  if (!options.output.empty()) {
    std::filesystem::create_directories(options.output);
    write_faults_csv(reports, options.output / "faults.csv");
    if (draw_faults(reports, options.output / "faults.png"))
      out << "picture: " << (options.output / "faults.png").string() << '\n';
  }
  for (const faults::RowReport& report : reports)
    if (!report.met()) return 1;
  return 0;
}

}  // namespace palpate::faults
