#include "tools/lab/studies/study_report.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tools/common/output_files.hpp"
#include "tools/common/plot.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/scores/report.hpp"
#include "tools/lab/studies/html.hpp"
#include "tools/lab/studies/poke_score.hpp"
#include "tools/lab/studies/study_overview.hpp"
#include "tools/lab/studies/study_tactile.hpp"

namespace palpate::studies {
namespace {

using Json = nlohmann::json;

constexpr const char* kAbout =
    "Simulator and daemon run as separate programs over LCM; every figure is taken on the "
    "simulated plant's truth, which the daemon cannot read. Shape error is the distance of the "
    "estimate's nodes from where the plant's material is, over the last half second of a state, in "
    "mm, in % of the object's largest side and of its largest true displacement. Hausdorff: the "
    "larger of the largest distances of either surface from the other. Octree agreement: the share "
    "of one surface's points that lie in cubes which the other's occupy; the thesis gives neither "
    "its resolution nor its formula. Pose error: estimate minus plant, of the frame through the "
    "three points that the thesis uses, in the object's frame. A figure is the median over the "
    "seeds, with its 95 % bootstrap interval in brackets (of shares Wilson's interval); in "
    "summaries over the states, medians of means and of maxima. "
    "Latency is that of a whole cycle of palpated; in lock-step none is measured.";

common::Curve curve_of(const Json& data, const std::string& values, const std::string& title,
                       double least, bool dashed) {
  common::Curve curve{title, {}, {}, dashed};
  if (!data.is_object() || !data.contains(values)) return curve;
  curve.x = data.at("time_s").get<std::vector<double>>();
  curve.y = data.at(values).get<std::vector<double>>();
  for (double& y : curve.y) y = std::max(y, least);
  return curve;
}

/// Pose error in one state after the other, as in the thesis' Fig. 4.15.
common::Curve pose_curve(const Json& states, const std::string& title) {
  common::Curve curve{title, {}, {}, false};
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!states[i].contains("pose_mm")) continue;
    curve.x.push_back(static_cast<double>(i + 1));
    curve.y.push_back(std::max(1e-3, states[i]["pose_mm"].get<double>()));
  }
  return curve;
}

/// The first seed's result of each method under a level.
std::vector<const StudyResult*> first_seeds(const StudyApplication& application,
                                            const std::vector<StudyResult>& results,
                                            const std::string& level) {
  std::vector<const StudyResult*> first;
  for (const runs::Method& method : application.methods)
    for (const StudyResult& result : results) {
      if (result.job.application != application.name || result.job.method != method.name ||
          result.job.mismatch != level || !result.json.is_object())
        continue;
      first.push_back(&result);
      break;
    }
  return first;
}

std::vector<common::Plot> plots_of(const StudyApplication& application,
                                   const std::vector<const StudyResult*>& runs,
                                   const std::string& level) {
  const std::string suffix = ", model error: " + level;
  common::Plot shape{"Mean shape error" + suffix, "time, s", "mm", {}, true};
  common::Plot pose{
      "Distance of the estimated pose from the plant's" + suffix, "state", "mm", {}, true};
  common::Plot feature{
      "Distance of the feature from its target" + suffix, "time, s", "mm", {}, true};
  common::Plot curvature{"Curvature from its target" + suffix, "time, s", "1/m", {}, true};
  common::Plot angle{"Angle from the target" + suffix, "time, s", "degrees", {}, true};
  common::Plot command{"Commanded speed" + suffix, "time, s", "mm/s", {}, false};
  common::Plot modulus{"Young's modulus, as estimated" + suffix, "time, s", "kPa", {}, false};
  int colour = 0;
  for (const StudyResult* run : runs) {
    const Json control = run->json.value("control", Json());
    const std::string& method = run->job.method;
    ++colour;
    const auto add = [colour](common::Plot& plot, common::Curve curve) {
      curve.colour = colour;
      plot.curves.push_back(std::move(curve));
    };
    add(shape, curve_of(run->json.value("shape_error", Json()), "mean_mm", method, 1e-3, false));
    add(pose, pose_curve(run->json.value("states", Json::array()), method));
    const Json belief = run->json.value("belief", Json::object()).value("curve", Json());
    add(modulus, curve_of(belief, "young_modulus_kpa", method, 0, false));
    if (!control.is_object()) continue;
    add(feature, curve_of(control["plant"], "mm", method + ", plant", 1e-2, false));
    add(feature, curve_of(control["estimate"], "mm", method + ", estimate", 1e-2, true));
    add(curvature, curve_of(control["plant"], "per_m", method + ", plant", 1e-3, false));
    add(curvature, curve_of(control["estimate"], "per_m", method + ", estimate", 1e-3, true));
    add(angle, curve_of(control["plant"], "deg", method + ", plant", 1e-3, false));
    add(command, curve_of(control["command"], "mm_per_s", method, 0, false));
  }
  std::vector<common::Plot> plots{shape};
  if (application.kind == "control")
    plots.insert(plots.end(), {feature, curvature, angle, command});
  else
    plots.push_back(pose);
  plots.push_back(modulus);
  for (common::Plot& plot : plots)
    plot.curves.erase(std::remove_if(plot.curves.begin(), plot.curves.end(),
                                     [](const common::Curve& curve) { return curve.x.empty(); }),
                      plot.curves.end());
  plots.erase(std::remove_if(plots.begin(), plots.end(),
                             [](const common::Plot& plot) { return plot.curves.empty(); }),
              plots.end());
  return plots;
}

void add_pictures(HtmlPage& page, const StudyReport& report,
                  const std::vector<const StudyResult*>& runs) {
  for (const StudyResult* run : runs)
    for (const Json& state : run->json.value("states", Json::array())) {
      const std::string file = state.value("picture", "");
      const std::string caption =
          state.value("name", "") + ", " + run->job.method + ", model error: " + run->job.mismatch +
          ", seed " + std::to_string(run->job.seed) + ": measured (" +
          state.value("measured", common::kNotAvailable) + "), estimate, both";
      if (!file.empty()) page.picture(report.folder / run->job.name / file, caption);
    }
}

void add_table(HtmlPage& page, const std::string& title, const ReportTable& table) {
  if (table.rows.empty()) return;
  page.heading(3, title);
  page.table(table.header, table.rows);
}

void add_application(HtmlPage& page, const StudyReport& report,
                     const StudyApplication& application) {
  page.heading(2, application.name);
  page.paragraph("Kind: " + application.kind + "; scene " + application.scene.filename().string() +
                 ", configuration " + application.configuration.filename().string() +
                 "; octree resolution " + common::number(report.plan.octree_resolution * 1e3, 1) +
                 " mm.");
  if (!application.note.empty()) page.paragraph(application.note);
  add_table(page, "Published", published_table(application));
  if (application.kind == "control")
    add_table(page, "Control", control_table(application, report.results));
  if (application.kind == "tactile")
    add_table(page, "Camera's cloud and contact forces",
              tactile_table(application, report.results));
  if (application.kind == "force") {
    add_table(page, "Pokes that nothing measures: median / worst",
              poke_table(application, report.results));
    add_table(page, "Poke by poke", each_poke_table(application, report.results));
  }
  add_table(page, "Shape, pose and cost", summary_table(application, report.results));
  add_table(page, "By state", state_table(application, report.results));
  for (const runs::Mismatch& level : application.levels) {
    const auto runs = first_seeds(application, report.results, level.name);
    const std::vector<common::Plot> plots = plots_of(application, runs, level.name);
    if (!plots.empty()) {
      const std::filesystem::path svg =
          report.folder / (common::file_name(application.name + " " + level.name) + ".svg");
      if (common::draw(plots, svg))
        page.picture(svg, "Over time, seed " + std::to_string(runs.front()->job.seed));
      else
        page.paragraph("No plots: gnuplot is not installed.");
    }
    add_pictures(page, report, runs);
  }
}

std::string text_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

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
  for (const std::string& failure : report.failures) out << "FAILED: " << failure << '\n';
}

std::string study_page(const StudyReport& report) {
  HtmlPage page("palpate: " + report.title);
  page.paragraph(kAbout);
  page.heading(2, "Host");
  std::vector<std::vector<std::string>> host{{"version", PALPATE_VERSION}};
  for (const auto& entry : report.host.items())
    host.push_back({entry.key(), text_of(entry.value())});
  page.table({"", ""}, host);
  if (!report.failures.empty()) {
    page.heading(2, "Jobs that failed");
    for (const std::string& failure : report.failures) page.preformatted(failure);
  }
  page.heading(2, "All applications together");
  const ReportTable overview = overview_table(report.plan, report.results);
  page.table(overview.header, overview.rows);
  for (const StudyApplication& application : report.plan.applications)
    if (has_jobs(report, application)) add_application(page, report, application);
  return page.text();
}

void write_study(const StudyReport& report) {
  write_text(study_page(report), report.folder / "report.html");
  std::ostringstream states, runs;
  write_states_csv(report.results, states);
  write_text(states.str(), report.folder / "states.csv");
  write_runs_csv(report.results, runs);
  write_text(runs.str(), report.folder / "runs.csv");
  Json json{{"version", PALPATE_VERSION}, {"host", report.host}, {"failures", report.failures}};
  json["octree_resolution_mm"] = report.plan.octree_resolution * 1e3;
  for (const StudyApplication& application : report.plan.applications)
    for (const PublishedFigure& figure : application.published)
      json["published"].push_back({{"application", application.name},
                                   {"quantity", figure.quantity},
                                   {"value", figure.value}});
  json["runs"] = Json::array();
  for (const StudyResult& result : report.results)
    if (result.json.is_object()) json["runs"].push_back(result.json);
  common::write_json(json, report.folder / (report.name + ".json"));
}

}  // namespace palpate::studies
