#include "tools/lab/studies/study_tables.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>

#include "tools/common/output_files.hpp"

namespace palpate::studies {
namespace {

using Json = nlohmann::json;

/// A number of a state.
struct StateColumn {
  const char* header;
  const char* key;
  int decimals;
  bool largest = false;  // over the states, instead of the mean
  double scale = 1;
  bool most_is_best = false;
};

constexpr StateColumn kShape[] = {
    {"mean mm", "mean_mm", 2},
    {"% of side", "mean_percent_of_length", 2},
    {"% of displ.", "mean_percent_of_displacement", 1},
    {"RMS mm", "rms_mm", 2},
    {"max mm", "max_mm", 2, true},
    {"% of side", "max_percent_of_length", 2, true},
    {"% of displ.", "max_percent_of_displacement", 1, true},
    {"Hausdorff mm", "hausdorff_mm", 2, true},
    {"octree: estimate in truth %", "octree_estimate_in_truth", 1, false, 100, true},
    {"truth in estimate %", "octree_truth_in_estimate", 1, false, 100, true},
    {"pose mm", "pose_mm", 2},
    {"pose deg", "pose_deg", 2}};

constexpr StateColumn kPose[] = {{"x mm", "pose_x_mm", 2},     {"y mm", "pose_y_mm", 2},
                                 {"z mm", "pose_z_mm", 2},     {"rx deg", "pose_rx_deg", 2},
                                 {"ry deg", "pose_ry_deg", 2}, {"rz deg", "pose_rz_deg", 2}};

/// A number of a run.
struct RunColumn {
  const char* header;
  const char* pointer;
  int decimals;
  bool most_is_best = false;
};

constexpr RunColumn kCost[] = {{"p50 us", "/score/loop/latency_us/p50", 0},
                               {"p99 us", "/score/loop/latency_us/p99", 0},
                               {"max us", "/score/loop/latency_us/max", 0},
                               {"real-time factor", "/simulator/real_time_factor", 2, true}};

constexpr RunColumn kControl[] = {
    {"error at rest mm", "/score/feature/error_mm", 2},
    {"deg", "/score/feature/error_deg", 2},
    {"1/m", "/score/feature/error_per_m", 3},
    {"% of way", "/score/feature/error_percent_of_way", 1},
    {"as palpated sees it mm", "/score/feature/error_that_the_daemon_sees_mm", 2},
    {"to 5 mm, 1 deg s", "/score/feature/time_to_5mm_s", 1},
    {"to 2 mm, 0.4 deg s", "/score/feature/time_to_2mm_s", 1},
    {"to 1 mm, 0.2 deg s", "/score/feature/time_to_1mm_s", 1},
    {"to 5 % of way s", "/score/feature/time_to_5_percent_of_way_s", 1},
    {"overshoot %", "/score/feature/overshoot_percent", 1},
    {"path mm", "/score/feature/path_mm", 1},
    {"unreachable, as palpated sees it mm", "/score/feature/unreachable_as_the_daemon_sees_it_mm",
     2},
    {"worst point mm", "/score/feature/error_of_the_worst_point_mm", 2}};

using Group = std::vector<const Json*>;  // results that differ only by their seed or draw

bool is_drawn(const Group& group) { return !group.empty() && group.front()->contains("draw"); }

/// Of one result; `state` empty: over all of them.
std::vector<double> state_values(const Json& result, const std::string& state, const char* key) {
  std::vector<double> values;
  for (const Json& entry : result.value("states", Json::array()))
    if ((state.empty() || entry.value("name", "") == state) && entry.contains(key))
      values.push_back(entry[key].get<double>());
  return values;
}

double reduced(const std::vector<double>& values, bool largest) {
  if (largest) return *std::max_element(values.begin(), values.end());
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::string cell(const Group& group, const std::string& state, const StateColumn& column) {
  std::vector<double> seeds;
  for (const Json* result : group) {
    const std::vector<double> values = state_values(*result, state, column.key);
    if (!values.empty()) seeds.push_back(column.scale * reduced(values, column.largest));
  }
  return spread(std::move(seeds), column.decimals, is_drawn(group), column.most_is_best);
}

std::string cell(const Group& group, const RunColumn& column) {
  std::vector<double> seeds;
  int never = 0;
  for (const Json* result : group) {
    const Json::json_pointer pointer(column.pointer);
    if (!result->contains(pointer)) continue;
    const Json& value = result->at(pointer);
    value.is_number() ? seeds.push_back(value.get<double>()) : void(++never);
  }
  if (never > 0 && seeds.empty()) return "never";
  const std::string text = spread(seeds, column.decimals, is_drawn(group), column.most_is_best);
  return never == 0 ? text : text + ", never in " + std::to_string(never);
}

template <class Columns>
void add_headers(ReportTable& table, const Columns& columns) {
  for (const auto& column : columns) table.header.emplace_back(column.header);
}

void for_each_group(const StudyApplication& application, const std::vector<StudyResult>& results,
                    ReportTable& table,
                    const std::function<void(const Group&, std::vector<std::string>&)>& add_cells) {
  for (const std::string& level : level_names(application)) {
    table.rows.push_back({level_title(application, level)});
    for (const runs::Method& method : application.methods) {
      const Group group = results_of(application, results, method.name, level);
      std::vector<std::string> row{method.name};
      add_cells(group, row);
      row.push_back(std::to_string(group.size()));
      table.rows.push_back(row);
    }
  }
  table.header.emplace_back("seeds");
}

std::vector<std::string> state_names(const StudyApplication& application,
                                     const std::vector<StudyResult>& results) {
  std::vector<std::string> names;
  for (const StudyResult& result : results) {
    if (result.job.application != application.name || result.json.is_null()) continue;
    for (const Json& state : result.json.value("states", Json::array())) {
      const std::string name = state.value("name", "");
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

/// Mean of a number over the states; the cap if the run failed, which is also the upper bound.
double capped_mean(const StudyResult& result, const char* key, double cap) {
  if (!result.json.is_object()) return cap;
  double sum = 0;
  for (const Json& state : result.json["states"]) sum += std::min(cap, state[key].get<double>());
  return sum / static_cast<double>(result.json["states"].size());
}

/// The share of sorted values, by the nearest rank.
double quantile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

std::vector<std::string> level_names(const StudyApplication& application) {
  std::vector<std::string> names;
  for (const runs::Mismatch& level : application.levels) {
    const std::string& name = level.family.empty() ? level.name : level.family;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::string level_title(const StudyApplication& application, const std::string& level) {
  const auto draws =
      std::count_if(application.levels.begin(), application.levels.end(),
                    [&level](const runs::Mismatch& other) { return other.family == level; });
  const std::string title = "model error: " + level;
  return draws == 0 ? title : title + ", draws: " + std::to_string(draws) + ": median; 90 %; worst";
}

bool is_of_level(const StudyJob& job, const std::string& level) {
  return job.mismatch == level || (!job.family.empty() && job.family == level);
}

std::string spread(std::vector<double> values, int decimals, bool is_drawn, bool most_is_best) {
  if (!is_drawn || values.empty()) return common::median_and_interval(values, decimals);
  std::string text = common::number(common::median_of(values).value, decimals);
  std::sort(values.begin(), values.end());
  if (most_is_best) std::reverse(values.begin(), values.end());
  for (const double value : {quantile(values, 0.9), values.back()})
    text += "; " + common::number(value, decimals);
  return text;
}

std::vector<const nlohmann::json*> results_of(const StudyApplication& application,
                                              const std::vector<StudyResult>& results,
                                              const std::string& method, const std::string& level) {
  Group group;
  for (const StudyResult& result : results)
    if (result.job.application == application.name && result.job.method == method &&
        is_of_level(result.job, level) && !result.json.is_null())
      group.push_back(&result.json);
  return group;
}

ReportTable summary_table(const StudyApplication& application,
                          const std::vector<StudyResult>& results) {
  ReportTable table{{"method"}, {}};
  add_headers(table, kShape);
  add_headers(table, kCost);
  for_each_group(application, results, table, [](const Group& group, auto& row) {
    for (const StateColumn& column : kShape) row.push_back(cell(group, "", column));
    for (const RunColumn& column : kCost) row.push_back(cell(group, column));
  });
  return table;
}

ReportTable state_table(const StudyApplication& application,
                        const std::vector<StudyResult>& results) {
  ReportTable table{{"method"}, {}};
  add_headers(table, kShape);
  add_headers(table, kPose);
  for (const std::string& level : level_names(application)) {
    for (const std::string& state : state_names(application, results)) {
      table.rows.push_back({state + ", " + level_title(application, level)});
      for (const runs::Method& method : application.methods) {
        const Group group = results_of(application, results, method.name, level);
        std::vector<std::string> row{method.name};
        for (const StateColumn& column : kShape) row.push_back(cell(group, state, column));
        for (const StateColumn& column : kPose) row.push_back(cell(group, state, column));
        table.rows.push_back(row);
      }
    }
  }
  return table;
}

ReportTable control_table(const StudyApplication& application,
                          const std::vector<StudyResult>& results) {
  ReportTable table{{"method"}, {}};
  add_headers(table, kControl);
  for_each_group(application, results, table, [](const Group& group, auto& row) {
    for (const RunColumn& column : kControl) row.push_back(cell(group, column));
  });
  return table;
}

ReportTable errors_table(const StudyApplication& application,
                         const std::vector<StudyResult>& results, double cap) {
  ReportTable table{{application.name + ", mean / Hausdorff, mm"}, {}};
  const std::vector<std::string> levels = level_names(application);
  table.header.insert(table.header.end(), levels.begin(), levels.end());
  bool any = false;
  for (const runs::Method& method : application.methods) {
    std::vector<std::string> row{method.name};
    for (const std::string& level : levels) {
      std::vector<double> means, surfaces;
      bool drawn = false;
      for (const StudyResult& result : results) {
        const StudyJob& job = result.job;
        if (job.application != application.name || job.method != method.name ||
            !is_of_level(job, level) || !(result.failed || result.json.is_object()))
          continue;
        means.push_back(capped_mean(result, "mean_mm", cap));
        surfaces.push_back(capped_mean(result, "hausdorff_mm", cap));
        drawn = !job.family.empty();
      }
      any = any || !means.empty();
      const auto text = [drawn](const std::vector<double>& values) {
        return drawn ? spread(values, 2, true) : common::number(common::median_of(values).value, 2);
      };
      row.push_back(means.empty() ? "" : text(means) + " / " + text(surfaces));
    }
    table.rows.push_back(row);
  }
  if (!any) table.rows.clear();
  return table;
}

ReportTable published_table(const StudyApplication& application) {
  ReportTable table{{"published in the thesis", "value"}, {}};
  for (const PublishedFigure& figure : application.published)
    table.rows.push_back({figure.quantity, figure.value});
  return table;
}

void write_states_csv(const std::vector<StudyResult>& results, std::ostream& out) {
  std::set<std::string> keys;
  for (const StudyResult& result : results)
    if (result.json.is_object())
      for (const Json& state : result.json.value("states", Json::array()))
        for (const auto& entry : state.items())
          if (entry.value().is_primitive() && entry.key() != "name") keys.insert(entry.key());
  out << "application,kind,method,model_error,seed,state";
  for (const std::string& key : keys) out << ',' << common::csv_cell(key);
  out << "\r\n";
  for (const StudyResult& result : results) {
    if (!result.json.is_object()) continue;
    const StudyJob& job = result.job;
    for (const Json& state : result.json.value("states", Json::array())) {
      out << common::csv_cell(job.application) << ',' << common::csv_cell(job.kind) << ','
          << common::csv_cell(job.method) << ',' << common::csv_cell(job.mismatch) << ','
          << job.seed << ',' << common::csv_cell(state.value("name", ""));
      for (const std::string& key : keys)
        out << ',' << (state.contains(key) ? common::csv_cell(state[key]) : "");
      out << "\r\n";
    }
  }
}

}  // namespace palpate::studies
