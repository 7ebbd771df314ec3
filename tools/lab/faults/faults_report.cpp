#include "tools/lab/faults/faults_report.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tools/common/plot.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/faults/rows.hpp"

namespace palpate::faults {
namespace {

using faults::kOutcomes;
using faults::RowReport;

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

std::string limit_of(const faults::Row& row) {
  return std::isfinite(row.limit) ? "<= " + amount(row.limit, row.unit) : "none";
}

}  // namespace

void print_faults(const std::vector<RowReport>& reports, std::ostream& out) {
  common::Table table({"fault", "unaffected", "degraded", "safe stop", "failed", "state ms",
                       "told ms", "back ms", "measured", "figure", ""});
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
  out << "State: longest until it is other than active; told: until HEALTH or an event says so; "
         "back: from the fault's end.\n";
  for (const RowReport& report : reports)
    if (!report.met())
      out << "MISSED " << report.row.number << ' ' << report.row.fault << " (" << report.row.figure
          << "): " << amount(report.measured, report.row.unit) << ", " << report.below_figure
          << " of " << report.seeds << " seeds; " << report.miss << '\n';
  for (const faults::Elsewhere& row : faults::rows_elsewhere())
    out << row.number << ' ' << row.fault << ": " << row.where << '\n';
  out << "survived " << survived << " of " << seeds << " seeds (95 %: at least "
      << common::number(100 * faults::wilson_lower(survived, seeds), 2) << " %), " << crashes
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
                          {"wilson_95", faults::wilson_lower(report.survived(), report.seeds)},
                          {"crashes", report.crashes},
                          {"state_s", report.detected},
                          {"told_s", report.visible},
                          {"back_s", report.recovered},
                          {"measured", report.measured},
                          {"unit", report.row.unit},
                          {"met", report.met()},
                          {"missed_seeds", report.below_figure},
                          {"first_miss", report.miss}};
    if (std::isfinite(report.row.limit)) row["limit"] = report.row.limit;
    for (int i = 0; i < kOutcomes; ++i)
      row["outcomes"][name(static_cast<faults::Outcome>(i))] = report.outcomes[i];
    json.push_back(row);
  }
  return json;
}

void write_faults_csv(const std::vector<RowReport>& reports, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "row,fault,seeds,unaffected,degraded,safe_stop,failed,crashes,wilson_95,state_s,told_s,"
         "back_s,measured,unit,limit,met,missed_seeds\n";
  for (const RowReport& report : reports) {
    out << report.row.number << ",\"" << report.row.fault << "\"," << report.seeds;
    for (const int count : report.outcomes) out << ',' << count;
    out << ',' << report.crashes << ',' << faults::wilson_lower(report.survived(), report.seeds)
        << ',' << report.detected << ',' << report.visible << ',' << report.recovered << ','
        << report.measured << ",\"" << report.row.unit << "\"," << report.row.limit << ','
        << (report.met() ? 1 : 0) << ',' << report.below_figure << '\n';
  }
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

bool draw_faults(const std::vector<RowReport>& reports, const std::filesystem::path& picture) {
  common::ColourMatrix matrix;
  matrix.title = "% of " + std::to_string(reports.front().seeds) +
                 " seeds (longest time until the state tells / is back)";
  constexpr unsigned kColours[] = {0x2e9e4f, 0xe8b923, 0x2f6fb5, 0xc8322b};
  for (int i = 0; i < kOutcomes; ++i) {
    matrix.columns.push_back(name(static_cast<faults::Outcome>(i)));
    matrix.colours.push_back(kColours[i]);
  }
  for (const RowReport& report : reports) {
    std::string times = milliseconds(report.detected) + " / " + milliseconds(report.recovered);
    matrix.rows.push_back(report.row.number + " " + report.row.fault +
                          (report.detected < 0 ? "" : "  (" + times + " ms)") +
                          (report.met() ? "" : "  MISSED"));
    std::vector<double> shares;
    for (const int count : report.outcomes)
      shares.push_back(static_cast<double>(count) / report.seeds);
    matrix.shares.push_back(shares);
  }
  return common::draw(matrix, picture);
}

}  // namespace palpate::faults
