#include "tools/lab/faults/faults.hpp"

#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/faults/campaign.hpp"
#include "tools/lab/faults/faults_process.hpp"

namespace palpate::faults {
namespace {

std::string milliseconds(double seconds) {
  return seconds < 0 ? "-" : common::number(1e3 * seconds, 0);
}

std::string amount(double value, const std::string& unit) {
  if (value < 0) return "-";
  std::ostringstream text;
  text.precision(4);
  text << value;
  return unit.empty() ? text.str() : text.str() + " " + unit;
}

std::string limit_of(const Row& row) {
  return std::isfinite(row.limit) ? "<= " + amount(row.limit, row.unit) : "none";
}

/// The table: outcomes, times to detect and to recover, each row's bound with the measured value,
/// every miss with its row and seed, and how many seeds survived.
void print_faults(const std::vector<RowReport>& reports, std::ostream& out) {
  common::Table table({"fault", "unaffected", "degraded", "safe stop", "failed", "state ms",
                       "reported ms", "back ms", "measured", "figure", ""});
  int seeds = 0, survived = 0, crashes = 0, missed = 0;
  for (const RowReport& report : reports) {
    std::vector<std::string> cells = {report.row.number + " " + report.row.fault};
    for (const int count : report.outcomes) cells.push_back(std::to_string(count));
    cells.insert(cells.end(),
                 {milliseconds(report.detected), milliseconds(report.visible),
                  milliseconds(report.recovered), amount(report.measured, report.row.unit),
                  limit_of(report.row), report.met() ? "met" : "MISSED"});
    table.add(cells);
    seeds += report.seeds;
    survived += report.survived();
    crashes += report.crashes;
    missed += report.met() ? 0 : 1;
  }
  table.print(out);
  out << "State: longest until it is other than active; reported: until HEALTH or an event says "
         "so; "
         "back: from the fault's end.\n";
  for (const RowReport& report : reports)
    if (!report.met())
      out << "MISSED " << report.row.number << ' ' << report.row.fault << " (" << report.row.figure
          << "): " << amount(report.measured, report.row.unit) << ", " << report.below_figure
          << " of " << report.seeds << " seeds; " << report.miss << '\n';
  for (const Elsewhere& row : rows_elsewhere())
    out << row.number << ' ' << row.fault << ": " << row.where << '\n';
  out << "survived " << survived << " of " << seeds << " seeds (95 %: at least "
      << common::number(100 * wilson_lower(survived, seeds), 2) << " %), " << crashes
      << " crashes or hangs, " << missed << " of " << reports.size() << " figures missed\n";
}

nlohmann::json faults_json(const std::vector<RowReport>& reports) {
  nlohmann::json json = nlohmann::json::array();
  for (const RowReport& report : reports) {
    nlohmann::json row = {{"row", report.row.number},
                          {"fault", report.row.fault},
                          {"figure", report.row.figure},
                          {"seeds", report.seeds},
                          {"survived", report.survived()},
                          {"wilson_95", wilson_lower(report.survived(), report.seeds)},
                          {"crashes", report.crashes},
                          {"state_s", report.detected},
                          {"reported_s", report.visible},
                          {"back_s", report.recovered},
                          {"measured", report.measured},
                          {"unit", report.row.unit},
                          {"met", report.met()},
                          {"missed_seeds", report.below_figure},
                          {"first_miss", report.miss}};
    if (std::isfinite(report.row.limit)) row["limit"] = report.row.limit;
    for (int i = 0; i < kOutcomes; ++i)
      row["outcomes"][name(static_cast<Outcome>(i))] = report.outcomes[i];
    json.push_back(row);
  }
  return json;
}

void write_faults_csv(const std::vector<RowReport>& reports, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "row,fault,seeds,unaffected,degraded,safe_stop,failed,crashes,wilson_95,state_s,reported_"
         "s,"
         "back_s,measured,unit,limit,met,missed_seeds\n";
  for (const RowReport& report : reports) {
    out << report.row.number << ",\"" << report.row.fault << "\"," << report.seeds;
    for (const int count : report.outcomes) out << ',' << count;
    out << ',' << report.crashes << ',' << wilson_lower(report.survived(), report.seeds) << ','
        << report.detected << ',' << report.visible << ',' << report.recovered << ','
        << report.measured << ",\"" << report.row.unit << "\"," << report.row.limit << ','
        << (report.met() ? 1 : 0) << ',' << report.below_figure << '\n';
  }
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

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
          "faults",
          "fault injection, in virtual time or into processes, and the outcome of each fault")) {
  command_->add_flag("--process", options_->process,
                     "injection into palpated itself over LCM and in real time, on separate ports");
  command_->add_option("--seeds", options_->seeds, "number of seeds of each row")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command_->add_option("--first-seed", options_->first_seed, "first seed, to repeat one")
      ->capture_default_str();
  command_->add_option("--rows", options_->rows, "numbers of rows, as 1,2,5 (default: all)")
      ->delimiter(',');
  command_->add_option("--jobs", options_->jobs, "number of concurrent processes")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command_->add_option("--json", options_->json, "file for the table, in addition");
  command_->add_option("--output", options_->output, "folder for faults.csv and faults.png");
}

FaultsCommand::~FaultsCommand() = default;

std::optional<int> FaultsCommand::run(std::ostream& out) {
  if (!command_->parsed()) return std::nullopt;
  const Options& options = *options_;
  const std::vector<Row> rows =
      options.process ? choose_process_rows(options.rows) : choose_rows(options.rows);
  const Bench bench = make_bench();
  std::vector<RowReport> reports;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    common::Progress progress(static_cast<int>(i) + 1, static_cast<int>(rows.size()),
                              rows[i].number + " " + rows[i].fault);
    reports.push_back(run_row(
        bench, rows[i], options.seeds, options.jobs,
        [&](int done) { progress.show(static_cast<double>(done) / options.seeds); },
        options.first_seed));
    progress.finish(reports.back().met(), name(reports.back().worst()));
  }
  print_faults(reports, out);
  if (!options.json.empty()) common::write_json(faults_json(reports), options.json);
  if (!options.output.empty()) {
    std::filesystem::create_directories(options.output);
    write_faults_csv(reports, options.output / "faults.csv");
    try {
      out << common::run_python("tools/lab/report/draw_faults",
                                {(options.output / "faults.csv").string()});
    } catch (const std::runtime_error& error) {
      std::cerr << "no picture: " << error.what() << '\n';
    }
  }
  for (const RowReport& report : reports)
    if (!report.met()) return 1;
  return 0;
}

}  // namespace palpate::faults
