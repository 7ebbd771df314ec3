#include "tools/lab/scores/report.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "tools/common/table.hpp"

namespace palpate::scores {
namespace {

using Json = nlohmann::json;

using math::kDegree;

std::string millimetres(double metres) { return common::number(metres * 1e3, 2); }
std::string percent(double fraction) { return common::number(fraction * 100, 2); }

std::vector<std::string> cells(const ScoredRun& run) {
  std::vector<std::string> row(14);
  row[0] = run.name;
  row[1] = run.mismatch;
  if (run.shape) {
    const ShapeScore& shape = *run.shape;
    const ErrorSummary error = shape.at_holds();
    row[2] = millimetres(error.mean);
    row[3] = percent(error.mean / shape.length);
    row[4] = millimetres(error.maximum);
    row[5] = percent(error.maximum / shape.length);
  }
  if (run.feature) {
    const FeatureScore& feature = *run.feature;
    if (feature.is_distance) row[6] = millimetres(feature.rest_distance);
    const bool has_angle = feature.kind == "pose" || feature.kind == "angle";
    if (has_angle) row[7] = common::number(feature.rest_angle / kDegree, 2);
    row[8] = feature.within_5mm ? common::number(*feature.within_5mm, 1) : "never";
  }
  if (run.loop) {
    row[9] = common::number(run.loop->p50_us, 0);
    row[10] = common::number(run.loop->p99_us, 0);
    row[11] = common::number(run.loop->p999_us, 0);
    row[12] = common::number(run.loop->max_us, 0);
    row[13] = std::to_string(run.loop->overruns);
  }
  return row;
}

Json to_json(const ErrorSummary& error, double length, double displacement) {
  Json json{{"mean_mm", error.mean * 1e3},
            {"rms_mm", error.rms * 1e3},
            {"max_mm", error.maximum * 1e3},
            {"mean_percent_of_length", 100 * error.mean / length},
            {"max_percent_of_length", 100 * error.maximum / length}};
  if (displacement > 0) json["mean_percent_of_displacement"] = 100 * error.mean / displacement;
  return json;
}

Json to_json(const ShapeScore& shape) {
  Json json{{"length_mm", shape.length * 1e3},
            {"shapes", shape.shapes},
            {"not_current", shape.not_current},
            {"largest_displacement_mm", shape.largest_displacement * 1e3},
            {"whole_run", to_json(shape.whole, shape.length, shape.largest_displacement)},
            {"at_rest", to_json(shape.at_holds(), shape.length, shape.largest_displacement)},
            {"in_motion", to_json(shape.in_motion, shape.length, shape.largest_displacement)}};
  json["at_rest"]["median_pose_mm"] = shape.median_hold() * 1e3;
  for (const HoldScore& hold : shape.holds) {
    Json pose = to_json(hold.error, shape.length, hold.displacement);
    pose["begin_s"] = hold.begin;
    pose["end_s"] = hold.end;
    pose["displacement_mm"] = hold.displacement * 1e3;
    json["poses"].push_back(pose);
  }
  return json;
}

Json optional_number(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

/// Distances are reported only for features that have one, bands of mm and degrees for these and
/// for angles.
Json to_json(const FeatureScore& feature) {
  Json json{{"kind", feature.kind},
            {"error_percent_of_way", 100 * feature.rest_size / feature.start_size},
            {"time_to_5_percent_of_way_s", optional_number(feature.within_twentieth)},
            {"overshoot_percent", feature.overshoot * 100},
            {"duration_s", feature.samples.back().time}};
  if (feature.kind == "curvature") {
    json["start_error_per_m"] = feature.start_size;
    json["error_per_m"] = feature.rest_size;
    json["error_that_the_daemon_sees_per_m"] = feature.estimated_size;
    json["unreachable_as_the_daemon_sees_it_per_m"] = feature.unreachable_size;
    return json;
  }
  if (feature.kind != "distance" && feature.kind != "fourier_contour")
    json["error_deg"] = feature.rest_angle / kDegree;
  json["time_to_5mm_s"] = optional_number(feature.within_5mm);
  json["time_to_2mm_s"] = optional_number(feature.within_2mm);
  json["time_to_1mm_s"] = optional_number(feature.within_1mm);
  if (!feature.is_distance) {
    json["start_error_deg"] = feature.start_size / kDegree;
    json["error_that_the_daemon_sees_deg"] = feature.estimated_size / kDegree;
    json["unreachable_as_the_daemon_sees_it_deg"] = feature.unreachable_size / kDegree;
    return json;
  }
  const Eigen::Vector3d target = feature.target * 1e3;
  json["target_mm"] = {target.x(), target.y(), target.z()};
  json["start_error_mm"] = feature.start_distance * 1e3;
  json["error_mm"] = feature.rest_distance * 1e3;
  json["error_that_the_daemon_sees_mm"] = feature.estimated_distance * 1e3;
  json["unreachable_as_the_daemon_sees_it_mm"] = feature.unreachable * 1e3;
  json["path_mm"] = feature.path * 1e3;
  if (feature.kind == "points") json["error_of_the_worst_point_mm"] = feature.rest_largest * 1e3;
  return json;
}

Json to_json(const LoopScore& loop) {
  return {
      {"cycles", loop.cycles},
      {"overruns", loop.overruns},
      {"allocations", loop.allocations},
      {"page_faults", loop.page_faults},
      {"overrun_ms", loop.overrun_ms},
      {"latency_us",
       {{"p50", loop.p50_us}, {"p99", loop.p99_us}, {"p99.9", loop.p999_us}, {"max", loop.max_us}}},
      {"wake_up_max_us", loop.wake_up_max_us},
      {"shapes_not_converged", loop.shapes_not_converged},
      {"gate_limited", loop.gate_limited},
      {"gate_rejected", loop.gate_rejected},
      {"last_trouble", loop.reason}};
}

Json to_json(const CommandScore& commands) {
  return {{"commands", commands.commands},
          {"linear_speed_mps", commands.linear_speed},
          {"angular_speed_radps", commands.angular_speed},
          {"linear_acceleration_mps2", commands.linear_acceleration},
          {"angular_acceleration_radps2", commands.angular_acceleration},
          {"violations", commands.violations},
          {"outside_workspace", commands.outside_workspace}};
}

Json to_json(const RecordingScore& recording) {
  const Eigen::Vector3d p = recording.location * 1e3;
  return {{"contact_s", recording.duration},
          {"force_rms_n", recording.force_rms},
          {"force_magnitude_rms_n", recording.force_magnitude_rms},
          {"true_force_rms_n", recording.true_force_rms},
          {"contact_location_mm", {p.x(), p.y(), p.z()}},
          {"largest_displacement_mm", recording.largest_displacement * 1e3}};
}

void print_recording(const ScoredRun& run, std::ostream& out) {
  const RecordingScore& score = *run.recording;
  const Eigen::Vector3d p = score.location * 1e3;
  out << run.name << ": contact at (" << common::number(p.x(), 1) << ", "
      << common::number(p.y(), 1) << ", " << common::number(p.z(), 1) << ") mm of the object for "
      << common::number(score.duration, 1) << " s; force error "
      << common::number(score.force_rms, 4) << " N RMS (of the vector), "
      << common::number(score.force_magnitude_rms, 4) << " N (of its size), truth "
      << common::number(score.true_force_rms, 3) << " N RMS; deepest indentation "
      << millimetres(score.largest_displacement) << " mm\n";
}

}  // namespace

void print_report(const std::vector<ScoredRun>& runs, std::ostream& out) {
  common::Table table({"run", "model error", "shape mm", "%", "max mm", "%", "feature mm", "deg",
                       "5 mm s", "p50 us", "p99", "p99.9", "max", "overruns"});
  std::string stage;
  for (const ScoredRun& run : runs) {
    if (run.stage != stage) table.section(stage = run.stage);
    table.add(cells(run));
  }
  table.print(out);
  out << "Shape error: plant against estimate at all nodes of the mesh, over the last half "
         "second "
         "of each pose\n(sensing) or over the whole run (control), mean and largest, in mm and % "
         "of "
         "the object's length. Feature\nerror: the plant's own, at rest; time into and staying "
         "within "
         "5 mm (and 1 degree).\n";
  for (const ScoredRun& run : runs) {
    const std::string title = run.name + (run.mismatch.empty() ? "" : " (" + run.mismatch + ")");
    if (run.recording) print_recording(run, out);
    if (!run.skipped.empty()) out << "skipped: " << title << ": " << run.skipped << '\n';
    if (!run.failure.empty()) out << "FAILED: " << title << ": " << run.failure << '\n';
    for (const std::string& missed : run.missed)
      out << "MISSED: " << title << ": " << missed << '\n';
  }
}

nlohmann::json to_json(const ScoredRun& run) {
  Json json{{"stage", run.stage}, {"name", run.name}};
  if (!run.mismatch.empty()) json["model_error"] = run.mismatch;
  if (run.shape) json["shape"] = to_json(*run.shape);
  if (run.feature) json["feature"] = to_json(*run.feature);
  if (run.loop) json["loop"] = to_json(*run.loop);
  if (run.commands) json["commands"] = to_json(*run.commands);
  if (run.recording) json["recording"] = to_json(*run.recording);
  if (!run.missed.empty()) json["missed"] = run.missed;
  if (!run.failure.empty()) json["failure"] = run.failure;
  if (!run.skipped.empty()) json["skipped"] = run.skipped;
  return json;
}

}  // namespace palpate::scores
