#include "tools/lab/shapes/shape_score.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"

namespace palpate::shapes {
namespace {

using nlohmann::json;

std::string verdict(const ShapeScore& score) {
  if (score.is_fitted) return "fitted";
  if (!score.goal) return "";
  return score.met() ? "met" : "MISSED";
}

json to_json(const ShapeScore& score) {
  return {{"quantity", score.quantity},
          {"unit", score.unit},
          {"error", score.error},
          {"deviation_of_recording", score.deviation > 0 ? json(score.deviation) : json(nullptr)},
          {"goal", common::or_null(score.goal)},
          {"fitted", score.is_fitted},
          {"met", score.goal ? json(score.met()) : json(nullptr)}};
}

json to_json(const ShapeOutline& outline) {
  json x = json::array(), y = json::array();
  for (int i = 0; i < outline.points.cols(); ++i) {
    x.push_back(outline.points(0, i));
    y.push_back(outline.points(1, i));
  }
  return {{"name", outline.name},
          {"x_mm", x},
          {"y_mm", y},
          {"measured", outline.is_measured},
          {"line", outline.is_line}};
}

}  // namespace

bool ShapeScore::met() const { return !goal || std::abs(error) <= *goal; }

bool ShapeResult::met() const {
  return std::all_of(scores.begin(), scores.end(),
                     [](const ShapeScore& score) { return score.met(); });
}

void print_shapes(const std::vector<ShapeResult>& results, std::ostream& out) {
  common::Table table({"quantity", "unit", "error", "recording's sd", "error / sd", "goal", ""});
  for (const ShapeResult& result : results) {
    table.section(result.recording + ", " + result.model + ", " + std::to_string(result.nodes) +
                  " nodes; " + result.material);
    for (const ShapeScore& score : result.scores) {
      const bool has_deviation = score.deviation > 0;
      table.add({score.quantity, score.unit, common::number(score.error, 2),
                 has_deviation ? common::number(score.deviation, 1) : "",
                 has_deviation ? common::number(std::abs(score.error) / score.deviation, 1) : "",
                 score.goal ? common::number(*score.goal, *score.goal < 1 ? 1 : 0) : "",
                 verdict(score)});
    }
  }
  table.print(out);
  out << "Errors are predicted minus measured, or distances; sd: standard deviation that the "
         "recording states.\n";
  for (const ShapeResult& result : results)
    for (const std::string& note : result.notes)
      out << result.recording << ", " << result.model << ": " << note << '\n';
}

json to_json(const ShapeResult& result) {
  json j{{"recording", result.recording},
         {"model", result.model},
         {"material", result.material},
         {"nodes", result.nodes},
         {"incremental_deviation_m", common::or_null(result.incremental_deviation)},
         {"notes", result.notes},
         {"scores", json::array()},
         {"outlines", json::array()},
         {"met", result.met()}};
  for (const ShapeScore& score : result.scores) j["scores"].push_back(to_json(score));
  for (const ShapeOutline& outline : result.outlines) j["outlines"].push_back(to_json(outline));
  return j;
}

}  // namespace palpate::shapes
