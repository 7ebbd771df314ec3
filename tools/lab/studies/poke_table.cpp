// The tables of poke_score.hpp.
#include <algorithm>
#include <cmath>
#include <functional>

#include "tools/common/bootstrap.hpp"
#include "tools/common/table.hpp"
#include "tools/lab/studies/poke_score.hpp"

namespace palpate::studies {
namespace {

using Json = nlohmann::json;
using Runs = std::vector<const Json*>;

constexpr double kLate = 50;  // ms, within which a measurable poke must be detected

Runs runs_of(const StudyApplication& application, const std::vector<StudyResult>& results,
             const std::string& method, const std::string& level) {
  Runs runs;
  for (const Json* result : results_of(application, results, method, level))
    if (result->contains("pokes")) runs.push_back(&result->at("pokes"));
  return runs;
}

std::vector<const Json*> pokes_of(const Runs& runs) {
  std::vector<const Json*> pokes;
  for (const Json* run : runs)
    for (const Json& poke : run->at("each")) pokes.push_back(&poke);
  return pokes;
}

std::vector<double> values(const std::vector<const Json*>& pokes, const char* pointer) {
  std::vector<double> found;
  const Json::json_pointer key(pointer);
  for (const Json* poke : pokes)
    if (poke->contains(key) && poke->at(key).is_number()) found.push_back(poke->at(key));
  return found;
}

std::string of(int count, std::size_t all) {
  return std::to_string(count) + " of " + std::to_string(all);
}

/// "median / largest".
std::string median_and_worst(std::vector<double> values, int decimals) {
  if (values.empty()) return common::kNotAvailable;
  return common::number(common::median_of(values).value, decimals) + " / " +
         common::number(*std::max_element(values.begin(), values.end()), decimals);
}

std::string cell(const Json& poke, const char* pointer, int decimals) {
  const Json::json_pointer key(pointer);
  if (!poke.contains(key) || !poke.at(key).is_number()) return "";
  return common::number(poke.at(key).get<double>(), decimals);
}

std::string vector_of(const Json& numbers) {
  std::string text;
  for (const Json& value : numbers) text += (text.empty() ? "" : " ") + common::number(value, 3);
  return text;
}

struct Figure {
  const char* header;
  const char* pointer;
  int decimals;
};

/// Median and worst of the pokes.
constexpr Figure kFigures[] = {
    {"place mm", "/place_mm", 1},
    {"force N off", "/force_off_n", 2},
    {"worst node, % of side: before", "/before/worst_percent_of_length", 2},
    {"largest", "/largest/worst_percent_of_length", 2},
    {"0.5 s after", "/half_second/worst_percent_of_length", 2},
    {"1 s after", "/second/worst_percent_of_length", 2},
    {"mean, % of side: 0.5 s after", "/half_second/mean_percent_of_length", 2}};

constexpr Figure kOfEach[] = {
    {"felt ms", "/felt_ms", 0},
    {"found ms", "/found_ms", 0},
    {"gone ms", "/gone_ms", 0},
    {"place mm", "/place_mm", 1},
    {"observable", "/observable", 2},
    {"force N off", "/force_off_n", 2},
    {"worst node, % of side: before", "/before/worst_percent_of_length", 2},
    {"largest", "/largest/worst_percent_of_length", 2},
    {"0.5 s after", "/half_second/worst_percent_of_length", 2},
    {"1 s after", "/second/worst_percent_of_length", 2}};

void add_row(ReportTable& table, const std::string& method, const Runs& runs) {
  const auto pokes = pokes_of(runs);
  std::vector<const Json*> felt, observable;
  int found = 0, in_time = 0;
  for (const Json* poke : pokes) {
    if (!poke->at("felt_ms").is_number()) continue;
    felt.push_back(poke);
    found += poke->at("found_ms").is_number() ? 1 : 0;
    in_time += poke->at("found_ms").is_number() && poke->at("found_ms") <= kLate ? 1 : 0;
    if (poke->at("observable").is_number() && poke->at("observable") > 0.5)
      observable.push_back(poke);
  }
  std::vector<std::string> row{method,
                               std::to_string(felt.size()) + " of " + std::to_string(pokes.size())};
  row.push_back(of(found, felt.size()));
  row.push_back(of(in_time, felt.size()));
  row.push_back(median_and_worst(values(felt, "/found_ms"), 0));
  row.push_back(median_and_worst(values(observable, "/place_mm"), 1) + " (" +
                std::to_string(observable.size()) + ")");
  for (const Figure& figure : kFigures)
    row.push_back(median_and_worst(values(pokes, figure.pointer), figure.decimals));
  int alarms = 0;
  double quiet = 0;
  for (const Json* run : runs) {
    alarms += run->at("false_alarms").get<int>();
    quiet += run->at("quiet_s").get<double>();
  }
  row.push_back(std::to_string(alarms) + " in " + common::number(quiet, 0));
  table.rows.push_back(row);
}

}  // namespace

ReportTable poke_table(const StudyApplication& application,
                       const std::vector<StudyResult>& results) {
  ReportTable table{{"method", "felt by the hand", "found", "within 50 ms", "ms from felt",
                     "place mm where reported observable"},
                    {}};
  for (const Figure& figure : kFigures) table.header.emplace_back(figure.header);
  table.header.emplace_back("false alarms in s");
  for (const std::string& level : level_names(application)) {
    bool is_first = true;
    for (const runs::Method& method : application.methods) {
      const Runs runs = runs_of(application, results, method.name, level);
      if (runs.empty()) continue;
      if (is_first) table.rows.push_back({"model error: " + level});
      is_first = false;
      add_row(table, method.name, runs);
    }
  }
  return table;
}

ReportTable each_poke_table(const StudyApplication& application,
                            const std::vector<StudyResult>& results) {
  ReportTable table{{"method", "at m", "N"}, {}};
  for (const Figure& figure : kOfEach) table.header.emplace_back(figure.header);
  for (const StudyResult& result : results) {
    if (result.job.application != application.name || !result.json.is_object() ||
        !result.json.contains("pokes"))
      continue;
    table.rows.push_back(
        {"model error: " + result.job.mismatch + ", seed " + std::to_string(result.job.seed)});
    for (const Json& poke : result.json["pokes"]["each"]) {
      std::vector<std::string> row{result.job.method, vector_of(poke["point_m"]),
                                   vector_of(poke["force_n"])};
      for (const Figure& figure : kOfEach)
        row.push_back(cell(poke, figure.pointer, figure.decimals));
      table.rows.push_back(row);
    }
  }
  return table;
}

}  // namespace palpate::studies
