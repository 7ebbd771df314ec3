#include "tools/lab/sensor_models/sensors_report.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/math/constants.hpp"
#include "core/sensing/biotac_geometry.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/plot.hpp"
#include "tools/common/table.hpp"

namespace palpate::sensor_models {
namespace {

using math::kDegree;
constexpr int kGroupColumns = 3;

/// mm on the skin that correspond to an angle of its normal.
double millimetres(double angle) { return 1e3 * sensing::kSkinRadius * angle; }

void add_cells(std::vector<std::string>& row, const Eigen::VectorXd& values, double scale,
               int decimals) {
  for (const double value : values) row.push_back(common::number(scale * value, decimals));
}

std::vector<std::string> header_of(SensorKind kind) {
  switch (kind) {
    case SensorKind::kForce:
      return {
          "fingertip force, N", "RMS x", "y", "z", "|F|", "mean abs. x", "y", "z", "r x", "y", "z"};
    case SensorKind::kDirection:
      return {"fingertip direction", "median deg", "90 % deg", "median mm", "90 % mm"};
    case SensorKind::kWrist:
      break;
  }
  return {"wrist, RMS; tared: recording mean",
          "|F| N",
          "|T| mN m",
          "x N",
          "y",
          "z",
          "x mN m",
          "y",
          "z",
          "first 2 s: |F| N",
          "|T| mN m"};
}

/// `again`: with the other tare, for a wrist.
std::vector<std::string> cells_of(SensorKind kind, const SensorScore& score,
                                  const SensorScore* again) {
  const recordings::Errors& errors = score.errors;
  std::vector<std::string> row{score.is_model ? score.method : "  " + score.method};
  switch (kind) {
    case SensorKind::kForce:
      add_cells(row, errors.rms, 1, 4);
      row.push_back(common::number(errors.norms[0], 4));
      add_cells(row, errors.mean_absolute, 1, 4);
      add_cells(row, errors.correlation, 1, 3);
      break;
    case SensorKind::kDirection:
      for (const double angle : {errors.median_angle[0], errors.angle_90[0]})
        row.push_back(common::number(angle / kDegree, 2));
      for (const double angle : {errors.median_angle[0], errors.angle_90[0]})
        row.push_back(common::number(millimetres(angle), 2));
      break;
    case SensorKind::kWrist:
      row.push_back(common::number(errors.norms[0], 3));
      row.push_back(common::number(1e3 * errors.norms[1], 1));
      add_cells(row, errors.rms.head(3), 1, 3);
      add_cells(row, errors.rms.tail(3), 1e3, 1);
      if (again != nullptr) {
        row.push_back(common::number(again->errors.norms[0], 3));
        row.push_back(common::number(1e3 * again->errors.norms[1], 1));
      }
      break;
  }
  return row;
}

const SensorScore* with_tare(const SensorComparison& comparison, const SensorScore& score,
                             SensorTare tare) {
  for (const SensorScore& other : comparison.scores)
    if (other.method == score.method && other.recording == score.recording && other.tare == tare)
      return &other;
  return nullptr;
}

/// Explanation of the errors of a kind.
std::string legend_of(SensorKind kind) {
  const recordings::DataPlan& plan = plan_of(kind).data;
  switch (kind) {
    case SensorKind::kForce:
      return "counts and forces are tared on " + common::number(plan.tare, 1) + " s at rest";
    case SensorKind::kDirection:
      return "rows in contact (PDC " + common::number(plan.contact_threshold, 0) +
             " counts above rest); mm on a skin of " +
             common::number(1e3 * sensing::kSkinRadius, 0) + " mm radius";
    case SensorKind::kWrist:
      break;
  }
  return "at " + common::number(plan.rate, 0) + " Hz, means over " +
         common::number(plan.average, 1) +
         " s; of every method alike, the mean error over the whole recording (or its first " +
         common::number(kFirstSeconds, 0) +
         " s) is taken off, as the sensor's bias of that session";
}

std::string json_name(SensorKind kind) { return common::file_name(name_of(kind)); }

std::vector<double> list(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

/// Indices of the first model and the first baseline among the methods.
std::vector<std::size_t> shown_methods(const SensorComparison& comparison) {
  std::vector<std::size_t> places;
  for (const bool model : {true, false})
    for (const SensorScore& score : comparison.scores)
      if (score.is_model == model) {
        const auto found =
            std::find(comparison.methods.begin(), comparison.methods.end(), score.method);
        places.push_back(static_cast<std::size_t>(found - comparison.methods.begin()));
        break;
      }
  return places;
}

common::Curve curve(const std::string& title, const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                    bool dashed) {
  return {title, list(x), list(y), dashed};
}

/// Angles between rows, degrees.
Eigen::VectorXd angles(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::VectorXd result(a.rows());
  for (Eigen::Index k = 0; k < a.rows(); ++k) {
    const Eigen::Vector3d u = a.row(k).transpose(), v = b.row(k).transpose();
    result[k] = std::atan2(u.cross(v).norm(), u.dot(v)) / kDegree;
  }
  return result;
}

std::vector<common::Plot> plots_of(const SensorComparison& comparison) {
  const std::vector<std::size_t> shown = shown_methods(comparison);
  std::vector<common::Plot> plots;
  if (comparison.kind == SensorKind::kDirection) {
    common::Plot plot{comparison.file + ": error of direction", "s", "degrees", {}};
    for (const std::size_t i : shown)
      plot.curves.push_back(curve(comparison.methods[i], comparison.time,
                                  angles(comparison.answers[i], comparison.truth), false));
    return {plot};
  }
  const auto& groups = plan_of(comparison.kind).data.outputs;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (int axis = 0; axis < kGroupColumns; ++axis) {
      const auto column = static_cast<Eigen::Index>(g) * kGroupColumns + axis;
      common::Plot plot{comparison.file + ": " + groups[g].columns[axis], "s", groups[g].unit, {}};
      plot.curves.push_back(
          curve("measured", comparison.time, comparison.truth.col(column), false));
      for (const std::size_t i : shown)
        plot.curves.push_back(
            curve(comparison.methods[i], comparison.time, comparison.answers[i].col(column), true));
      plots.push_back(plot);
    }
  return plots;
}

}  // namespace

void print_sensors(const std::vector<SensorComparison>& comparisons, std::ostream& out) {
  for (const SensorKind kind : {SensorKind::kForce, SensorKind::kDirection, SensorKind::kWrist}) {
    common::Table table(header_of(kind));
    bool any = false;
    for (const SensorComparison& comparison : comparisons) {
      if (comparison.kind != kind || comparison.scores.empty()) continue;
      any = true;
      table.section(comparison.file + ": " + comparison.origin + ", " +
                    std::to_string(comparison.scores.front().errors.rows) + " rows, " +
                    std::to_string(comparison.recordings.size()) +
                    (comparison.recordings.size() == 1 ? " recording" : " recordings"));
      for (const SensorScore& score : comparison.scores)
        if (score.recording.empty() && score.tare != SensorTare::kFirstSeconds)
          table.add(cells_of(kind, score, with_tare(comparison, score, SensorTare::kFirstSeconds)));
    }
    if (!any) continue;
    table.print(out);
    out << legend_of(kind) << "\n\n";
  }
}

void write_sensors_csv(const std::vector<SensorComparison>& comparisons, std::ostream& out) {
  out << "kind,file,recording,origin,method,learned,tare,rows";
  for (const char* quantity : {"rms", "mean_abs", "r"})
    for (const char* axis : {"1", "2", "3", "4", "5", "6"}) out << ',' << quantity << '_' << axis;
  out << ",rms_force_or_direction,rms_torque,median_deg,p90_deg,median_mm\n";
  for (const SensorComparison& comparison : comparisons)
    for (const SensorScore& score : comparison.scores) {
      const recordings::Errors& errors = score.errors;
      out << json_name(comparison.kind) << ',' << common::csv_cell(comparison.file) << ','
          << common::csv_cell(score.recording.empty() ? "all" : score.recording) << ','
          << comparison.origin << ',' << common::csv_cell(score.method) << ','
          << (score.is_model ? "yes" : "no") << ',' << name_of(score.tare) << ',' << errors.rows;
      for (const Eigen::VectorXd* values :
           {&errors.rms, &errors.mean_absolute, &errors.correlation})
        for (Eigen::Index i = 0; i < 6; ++i) {
          out << ',';
          if (i < values->size()) out << (*values)[i];
        }
      out << ',' << errors.norms[0] << ',';
      if (errors.norms.size() > 1) out << errors.norms[1];
      if (comparison.kind == SensorKind::kDirection)
        out << ',' << errors.median_angle[0] / kDegree << ',' << errors.angle_90[0] / kDegree << ','
            << millimetres(errors.median_angle[0]) << "\n";
      else
        out << ",,,\n";
    }
}

nlohmann::json to_json(const SensorComparison& comparison) {
  nlohmann::json json{{"kind", json_name(comparison.kind)},
                      {"file", comparison.file},
                      {"origin", comparison.origin},
                      {"recordings", comparison.recordings},
                      {"scores", nlohmann::json::array()}};
  const auto& groups = plan_of(comparison.kind).data.outputs;
  for (const SensorScore& score : comparison.scores) {
    nlohmann::json entry{{"method", score.method},
                         {"learned", score.is_model},
                         {"rows", score.errors.rows},
                         {"rms", list(score.errors.rms)},
                         {"mean_absolute", list(score.errors.mean_absolute)},
                         {"correlation", list(score.errors.correlation)}};
    if (!score.recording.empty()) entry["recording"] = score.recording;
    if (score.tare != SensorTare::kNone) entry["tare"] = name_of(score.tare);
    for (std::size_t g = 0; g < groups.size(); ++g)
      entry[groups[g].name + "_rms"] = score.errors.norms[g];
    if (comparison.kind == SensorKind::kDirection) {
      entry["median_deg"] = score.errors.median_angle[0] / kDegree;
      entry["p90_deg"] = score.errors.angle_90[0] / kDegree;
      entry["median_mm"] = millimetres(score.errors.median_angle[0]);
    }
    json["scores"].push_back(entry);
  }
  return json;
}

std::vector<std::filesystem::path> draw_sensors(const std::vector<SensorComparison>& comparisons,
                                                const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> pictures;
  for (const SensorComparison& comparison : comparisons) {
    std::string name = comparison.file;
    std::replace(name.begin(), name.end(), '/', '-');
    name = name.substr(0, name.rfind(".csv"));
    const std::filesystem::path picture = folder / (json_name(comparison.kind) + "-" + name + "-" +
                                                    std::to_string(pictures.size() + 1) + ".png");
    if (!common::try_draw(plots_of(comparison), picture)) return {};
    pictures.push_back(picture);
  }
  return pictures;
}

}  // namespace palpate::sensor_models
