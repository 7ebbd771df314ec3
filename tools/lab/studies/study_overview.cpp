#include "tools/lab/studies/study_tables.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "tools/common/output_files.hpp"

namespace palpate::studies {
namespace {

using Json = nlohmann::json;
using Pointer = Json::json_pointer;
using Runs = std::vector<const StudyResult*>;

/// Of a run, over its states.
std::optional<double> of_states(const Json& result, const char* key, bool largest) {
  std::vector<double> values;
  for (const Json& state : result.value("states", Json::array()))
    if (state.contains(key)) values.push_back(state[key].get<double>());
  if (values.empty()) return std::nullopt;
  if (largest) return *std::max_element(values.begin(), values.end());
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::optional<double> number_at(const Json& result, const char* pointer) {
  const Pointer at(pointer);
  if (!result.contains(at) || !result.at(at).is_number()) return std::nullopt;
  return result.at(at).get<double>();
}

template <class Value>
std::string median_over(const Runs& runs, int decimals, bool most_is_best, const Value& value) {
  std::vector<double> values;
  for (const StudyResult* run : runs)
    if (run->json.is_object())
      if (const std::optional<double> number = value(run->json)) values.push_back(*number);
  return spread(std::move(values), decimals, !runs.front()->job.family.empty(), most_is_best);
}

/// Over the runs with a target that is a position or a distance: those with a time of at most
/// `latest`.
std::string share_over(const Runs& runs, const char* pointer, double latest) {
  int reached = 0, trials = 0;
  for (const StudyResult* run : runs) {
    const auto& target = run->job.target;
    if (!target || target->kind == "angle" || target->kind == "curvature") continue;
    ++trials;
    if (run->failed) continue;
    const std::optional<double> time = number_at(run->json, pointer);
    reached += time && *time <= latest ? 1 : 0;
  }
  return common::share_and_interval(reached, trials);
}

constexpr double kSoon = 3, kEver = 1e9;  // s

void add_cells(const Runs& runs, std::vector<std::string>& row) {
  const auto states = [&](const char* key, bool largest) {
    row.push_back(median_over(runs, 2, false,
                              [&](const Json& result) { return of_states(result, key, largest); }));
  };
  const auto score = [&](const char* pointer, int decimals, bool most_is_best = false) {
    row.push_back(median_over(runs, decimals, most_is_best,
                              [&](const Json& result) { return number_at(result, pointer); }));
  };
  states("mean_percent_of_length", false);
  states("max_percent_of_length", true);
  score("/belief/within_95_percent_interval", 0, true);
  score("/belief/young_modulus_kpa", 1);
  score("/score/feature/error_mm", 2);
  row.push_back(share_over(runs, "/score/feature/time_to_5mm_s", kEver));
  row.push_back(share_over(runs, "/score/feature/time_to_5mm_s", kSoon));
  row.push_back(share_over(runs, "/score/feature/time_to_2mm_s", kSoon));
  row.push_back(share_over(runs, "/score/feature/time_to_1mm_s", kEver));
  score("/score/feature/overshoot_percent", 1);
}

/// Names in order of first occurrence in the plan.
void add_names(const std::vector<std::string>& from, std::vector<std::string>& names) {
  for (const std::string& name : from)
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

std::vector<std::string> method_names(const StudyApplication& application) {
  std::vector<std::string> names;
  for (const runs::Method& method : application.methods) names.push_back(method.name);
  return names;
}

}  // namespace

ReportTable overview_table(const StudyPlan& plan, const std::vector<StudyResult>& results) {
  std::vector<std::string> levels, methods;
  for (const StudyApplication& application : plan.applications) {
    add_names(level_names(application), levels);
    add_names(method_names(application), methods);
  }
  ReportTable table{{"method", "mean shape error, % of side", "max, % of side",
                     "within its 95 % interval, %", "E kPa", "feature's error mm", "5 mm and stays",
                     "5 mm in 3 s", "2 mm in 3 s", "1 mm and stays", "overshoot %", "runs"},
                    {}};
  for (const std::string& level : levels) {
    bool titled = false;
    for (const std::string& method : methods) {
      Runs runs;
      for (const StudyResult& result : results)
        if (is_of_level(result.job, level) && result.job.method == method &&
            (result.failed || result.json.is_object()))
          runs.push_back(&result);
      if (runs.empty()) continue;
      if (!titled)
        table.rows.push_back({"model error: " + level +
                              (runs.front()->job.family == level ? ": median; 90 %; worst" : "")});
      titled = true;
      std::vector<std::string> row{method};
      add_cells(runs, row);
      row.push_back(std::to_string(runs.size()));
      table.rows.push_back(row);
    }
  }
  return table;
}

void write_runs_csv(const std::vector<StudyResult>& results, std::ostream& out) {
  std::set<std::string> keys;
  std::map<const StudyResult*, Json> rows;
  for (const StudyResult& result : results) {
    if (!result.json.is_object()) continue;
    Json& row = rows[&result] = Json::object();
    for (const char* part : {"score", "belief"}) {
      const Json flat = result.json.value(part, Json::object()).flatten();
      for (const auto& entry : flat.items())
        if (entry.value().is_number() && entry.key().find("/curve/") == std::string::npos) {
          keys.insert(part + entry.key());
          row[part + entry.key()] = entry.value();
        }
    }
  }
  out << "application,method,model_error,seed,outcome,version,inputs_hash";
  for (const std::string& key : keys) out << ',' << common::csv_cell(key);
  out << "\r\n";
  for (const StudyResult& result : results) {
    const auto row = rows.find(&result);
    if (row == rows.end() && !result.failed) continue;
    out << common::csv_cell(result.job.application) << ',' << common::csv_cell(result.job.method)
        << ',' << common::csv_cell(result.job.mismatch) << ',' << result.job.seed << ','
        << (result.failed ? "failed" : "done") << ',' << PALPATE_VERSION << ','
        << (row == rows.end() ? "" : result.json.value("inputs_hash", ""));
    for (const std::string& key : keys) {
      out << ',';
      if (row != rows.end() && row->second.contains(key)) out << row->second[key].dump();
    }
    out << "\r\n";
  }
}

}  // namespace palpate::studies
