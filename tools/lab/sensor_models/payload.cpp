#include "tools/lab/sensor_models/payload.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"

namespace palpate::sensor_models {
namespace {

using math::kDegree;

nlohmann::json to_json(const PayloadScore& score) {
  const auto list = [](const auto& v) { return std::vector<double>(v.begin(), v.end()); };
  const sensing::PayloadParameters& p = score.fit.parameters;
  nlohmann::json json = {{"recording", score.recording},
                         {"readings", score.fit.sample_count},
                         {"mass", p.mass},
                         {"center_of_mass", list(p.center_of_mass())},
                         {"inertia", list(p.inertia)},
                         {"bias_force", list(p.bias.force)},
                         {"bias_torque", list(p.bias.torque)},
                         {"deviation", list(score.fit.deviation)},
                         {"residual_rms", list(score.fit.residual_rms)},
                         {"force_rms", score.fit.force_rms},
                         {"torque_rms", score.fit.torque_rms},
                         {"condition", score.fit.condition},
                         {"undetermined", score.fit.unidentified},
                         {"reversed", score.reversed},
                         {"gravity_tilt", score.gravity_tilt},
                         {"drift_force", list(score.fit.bias_drift.force)}};
  if (score.left_out_force >= 0) {
    json["left_out_force_rms"] = score.left_out_force;
    json["left_out_torque_rms"] = score.left_out_torque;
  }
  if (score.has_bar()) {
    json["bar"] = score.force_bar;
    json["bar_per_axis"] = score.bar_per_axis;
    json["met"] = score.met();
  }
  return json;
}

std::string triple(const Eigen::Vector3d& v, int decimals) {
  return common::number(v.x(), decimals) + " " + common::number(v.y(), decimals) + " " +
         common::number(v.z(), decimals);
}

void print(const std::vector<PayloadScore>& scores, std::ostream& out) {
  common::Table table({"recording", "readings", "mass kg", "centre mm", "residual x y z N", "|F| N",
                       "|T| mNm", "left out |F| N", "bar N", ""});
  for (const PayloadScore& score : scores) {
    const sensing::PayloadFit& fit = score.fit;
    std::string bar, verdict;
    if (score.has_bar()) {
      bar = common::number(score.force_bar, 2) + (score.bar_per_axis ? " an axis" : "");
      verdict = score.met() ? "met" : "MISSED";
    }
    table.add(
        {score.recording, std::to_string(fit.sample_count),
         common::number(fit.parameters.mass, 4) + " +- " + common::number(fit.deviation[0], 4),
         triple(1e3 * fit.parameters.center_of_mass(), 1), triple(fit.residual_rms.head<3>(), 3),
         common::number(fit.force_rms, 3), common::number(1e3 * fit.torque_rms, 1),
         score.left_out_force < 0 ? "" : common::number(score.left_out_force, 3), bar, verdict});
  }
  table.print(out);
  for (const PayloadScore& score : scores) {
    if (score.reversed)
      out << score.recording << ": the sensor reports what the load exerts on it (polarity -1)\n";
    if (score.gravity_tilt > 0.5 * kDegree)
      out << score.recording << ": gravity stands "
          << common::number(score.gravity_tilt / kDegree, 1) << " degrees off the base's -z\n";
    if (score.fit.bias_drift.force.norm() > 0)
      out << score.recording << ": the force bias drifts by "
          << triple(score.fit.bias_drift.force * (score.fit.sample_count - 1), 2)
          << " N from the first pose to the last\n";
    // Not excited at all, or so little that the value is below its own standard deviation.
    std::vector<std::string> weak = score.fit.unidentified;
    const sensing::PayloadVector values = sensing::to_vector(score.fit.parameters);
    for (int i = 4; i < 10; ++i) {
      const std::string name = sensing::payload_parameter_name(i);
      if (score.fit.deviation[i] > std::abs(values[i]) &&
          std::find(weak.begin(), weak.end(), name) == weak.end())
        weak.push_back(name);
    }
    if (weak.empty()) continue;
    out << score.recording << ": the data do not determine";
    for (const std::string& name : weak) out << " " << name;
    out << "\n";
  }
}

}  // namespace

int run_payload(const PayloadOptions& options, std::ostream& out) {
  struct Recording {
    const char* folder;
    PayloadScore (*score)(const std::filesystem::path&);
  };
  constexpr Recording kRecordings[] = {{"ft_static_ati", score_static_ati},
                                       {"ft_static_ati", score_static_ati_constant_bias},
                                       {"ft_static_meca500", score_static_meca500},
                                       {"ft_imu_kuka_ntnu", score_static_ntnu},
                                       {"ft_imu_kuka_ntnu", score_motion_ntnu},
                                       {"ft_imu_kuka_ntnu", score_motion_ntnu_gravity}};
  std::vector<PayloadScore> scores;
  for (const Recording& recording : kRecordings) {
    if (std::filesystem::exists(options.data / recording.folder)) {
      scores.push_back(recording.score(options.data));
    } else {
      out << recording.folder << ": absent below " << options.data.string() << "\n";
    }
  }
  if (!scores.empty()) print(scores, out);
  if (!options.json.empty()) {
    nlohmann::json json = nlohmann::json::array();
    for (const PayloadScore& score : scores) json.push_back(to_json(score));
    common::write_json(json, options.json);
  }
  if (scores.empty())
    throw std::runtime_error("no recording was found below " + options.data.string() +
                             "; this command scores " + kRecordings[0].folder + " and others");
  const bool all_met = std::all_of(scores.begin(), scores.end(),
                                   [](const PayloadScore& score) { return score.met(); });
  return all_met ? 0 : 1;
}

}  // namespace palpate::sensor_models
