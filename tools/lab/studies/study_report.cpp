#include "tools/lab/studies/study_report.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/studies/poke_score.hpp"
#include "tools/lab/studies/study_tactile.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kPagePatience = 900;  // s
// The interpreter for which the system's packages are built; another may come first in PATH.
constexpr const char* kSystemPython = "/usr/bin/python3";

bool has_jobs(const StudyReport& report, const StudyApplication& application) {
  return std::any_of(report.results.begin(), report.results.end(), [&](const StudyResult& result) {
    return result.job.application == application.name;
  });
}

void print_table(const ReportTable& from, std::ostream& out) {
  common::Table table(from.header);
  for (const std::vector<std::string>& row : from.rows)
    row.size() == 1 ? table.section(row[0]) : table.add(row);
  table.print(out);
}

/// The part of a wide table that fits a terminal.
ReportTable narrowed(const ReportTable& table, const std::vector<std::size_t>& columns) {
  ReportTable narrow;
  for (const std::size_t c : columns) narrow.header.push_back(table.header[c]);
  for (const std::vector<std::string>& row : table.rows) {
    if (row.size() == 1) {
      narrow.rows.push_back(row);
      continue;
    }
    narrow.rows.emplace_back();
    for (const std::size_t c : columns) narrow.rows.back().push_back(row[c]);
  }
  return narrow;
}

void write_text(const std::string& text, const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

Json json_of(const std::string& title, const ReportTable& table) {
  return {{"title", title}, {"header", table.header}, {"rows", table.rows}};
}

/// The tables of an application's section of the page.
Json json_of(const StudyReport& report, const StudyApplication& application) {
  Json json{{"name", application.name},
            {"kind", application.kind},
            {"note", application.note},
            {"scene", application.scene.filename().string()},
            {"configuration", application.configuration.filename().string()},
            {"model_errors", Json::array()},
            {"methods", Json::array()},
            {"tables", Json::array()}};
  // The page plots a run of each: of a distribution its first draw.
  for (const std::string& name : level_names(application))
    json["model_errors"].push_back(std::find_if(application.levels.begin(),
                                                application.levels.end(),
                                                [&name](const runs::Mismatch& level) {
                                                  return level.name == name || level.family == name;
                                                })
                                       ->name);
  for (const runs::Method& method : application.methods) json["methods"].push_back(method.name);
  const auto add = [&json](const std::string& title, const ReportTable& table) {
    if (!table.rows.empty()) json["tables"].push_back(json_of(title, table));
  };
  add("Published", published_table(application));
  if (application.kind == "control") add("Control", control_table(application, report.results));
  if (application.kind == "tactile")
    add("Camera's cloud and contact forces", tactile_table(application, report.results));
  if (application.kind == "force") {
    add("Pokes that nothing measures: median / worst", poke_table(application, report.results));
    add("Poke by poke", each_poke_table(application, report.results));
  }
  add("Shape, pose and cost", summary_table(application, report.results));
  add("By state", state_table(application, report.results));
  return json;
}

}  // namespace

void print_study(const StudyReport& report, std::ostream& out) {
  for (const StudyApplication& application : report.plan.applications) {
    if (!has_jobs(report, application)) continue;
    out << '\n' << application.name << '\n';
    if (application.kind == "control") print_table(control_table(application, report.results), out);
    const ReportTable pokes = poke_table(application, report.results);
    if (!pokes.rows.empty()) {
      out << "pokes: median / worst\n";
      print_table(pokes, out);
      print_table(each_poke_table(application, report.results), out);
    }
    // Mean, % of side, max, octree both ways, pose, latency, factor, seeds.
    print_table(narrowed(summary_table(application, report.results),
                         {0, 1, 2, 5, 8, 9, 10, 11, 12, 14, 16, 17}),
                out);
  }
  out << "\nall applications together\n";
  print_table(overview_table(report.plan, report.results), out);
}

void print_errors(const StudyReport& report, double cap, std::ostream& out) {
  for (const StudyApplication& application : report.plan.applications) {
    const ReportTable table = errors_table(application, report.results, cap);
    if (table.rows.empty()) continue;
    print_table(table, out);
    out << '\n';
  }
}

void write_study(const StudyReport& report) {
  std::ostringstream states, runs;
  write_states_csv(report.results, states);
  write_text(states.str(), report.folder / "states.csv");
  write_runs_csv(report.results, runs);
  write_text(runs.str(), report.folder / "runs.csv");
  Json json{{"version", PALPATE_VERSION},
            {"title", report.title},
            {"host", report.host},
            {"failures", report.failures},
            {"overview",
             json_of("All applications together", overview_table(report.plan, report.results))},
            {"applications", Json::array()}};
  json["octree_resolution_mm"] = report.plan.octree_resolution * 1e3;
  for (const StudyApplication& application : report.plan.applications)
    for (const PublishedFigure& figure : application.published)
      json["published"].push_back({{"application", application.name},
                                   {"quantity", figure.quantity},
                                   {"value", figure.value}});
  for (const StudyApplication& application : report.plan.applications)
    if (has_jobs(report, application)) json["applications"].push_back(json_of(report, application));
  json["runs"] = Json::array();
  for (const StudyResult& result : report.results)
    if (result.json.is_object()) json["runs"].push_back(result.json);
  common::write_json(json, report.folder / (report.name + ".json"));
}

std::string make_page(const StudyReport& report, const fs::path& root) {
  const std::string data = report.name + ".json";
  const fs::path page = report.folder / "report.html", said = report.folder / "report_study.txt";
  fs::remove(page);
  std::string reason;
  try {
    const int code = common::run_to_end(
        {fs::exists(kSystemPython) ? kSystemPython : "python3", "-B",
         (root / "tools/lab/report/report_study").string(), (report.folder / data).string()},
        said, kPagePatience);
    if (code != 0) reason = common::tail(said, 8);
  } catch (const std::runtime_error& error) {
    reason = error.what();
  }
  if (reason.empty()) {
    fs::remove(said);
    return "report.html, runs.csv, states.csv and " + data + " are in " + report.folder.string();
  }
  return "no report.html: " + reason + (reason.back() == '\n' ? "" : "\n") +
         "runs.csv, states.csv and " + data + " are complete, in " + report.folder.string();
}

}  // namespace palpate::studies
