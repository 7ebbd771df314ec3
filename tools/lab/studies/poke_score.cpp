#include "tools/lab/studies/poke_score.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/common/output_files.hpp"
#include "tools/lab/scores/belief_score.hpp"
#include "tools/log/plant_truth.hpp"

namespace palpate::studies {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::json;
using math::Vector6d;

constexpr double kForceNoise = 0.025, kTorqueNoise = 0.001;  // N, N m, of sim/sensors/sensors.yaml
constexpr double kDeviations = 5;
constexpr double kBefore = 0.5;  // s, over which the state before a poke is averaged
constexpr double kWindow = 0.5;  // s, over which contact point and force are averaged
constexpr double kLinger =
    0.5;  // s, after a poke, in which a reported contact is not a false alarm

/// The wrench of the hand on the object at the sensor, in the sensor's axes.
Vector6d at_sensor(const truth_contact_t& truth, const math::Pose& X_GS) {
  const math::Pose X_OG = math::make_pose(math::rotation_from_wxyz(truth.grasp_quaternion[0]),
                                          Eigen::Map<const Vector3d>(truth.grasp_position[0]));
  const math::Pose X_OS = X_OG * X_GS;
  const Eigen::Map<const Vector6d> wrench(truth.grasp_wrench[0]);
  const Vector3d lever = X_OG.translation() - X_OS.translation();
  const Vector3d torque = wrench.tail<3>() + lever.cross(Vector3d(wrench.head<3>()));
  Vector6d result;
  result << X_OS.linear().transpose() * wrench.head<3>(), X_OS.linear().transpose() * torque;
  return result;
}

/// Error of the worst axis in standard deviations of the sensor's noise.
double deviations(const Vector6d& change) {
  return std::max(change.head<3>().cwiseAbs().maxCoeff() / kForceNoise,
                  change.tail<3>().cwiseAbs().maxCoeff() / kTorqueNoise);
}

/// One run, in s since the start of the scene.
class Run {
 public:
  Run(const log::RunLog& log, const scores::ShapeScore& shape, const registry::Frames& frames,
      const math::Pose& X_OP)
      : log_(log),
        shape_(shape),
        plant_(log::assemble(log.truth_chunks)),
        motion_(log.truths),
        X_GS_(frames.X_EG.inverse() * frames.X_ES),
        X_OP_(X_OP),
        start_(log.truths.front().utime) {}

  double time(std::int64_t utime) const { return 1e-6 * static_cast<double>(utime - start_); }

  PokeScore score(const scenes::Poke& poke) const {
    PokeScore result;
    result.poke = poke;
    result.felt = felt(poke);
    const double from = poke.at + result.felt.value_or(0), end = poke.at + poke.duration;
    std::optional<double> found_at;
    for (const estimate_t& estimate : log_.estimates) {
      const double now = time(estimate.utime);
      if (now < poke.at) continue;
      if (now < end && !found_at && scores::reports_contact(estimate)) found_at = now;
      if (now >= end && found_at && !scores::reports_contact(estimate)) {
        result.gone = now - end;
        break;
      }
    }
    if (found_at) result.found = *found_at - from;
    score_contact(result);
    score_shape(result, found_at);
    return result;
  }

 private:
  /// The object may still oscillate: the start counts from when the change permanently exceeds the
  /// detection limit, until the full force is reached.
  std::optional<double> felt(const scenes::Poke& poke) const {
    const double ramp = std::min(scenes::Poke::kRamp, poke.duration / 2);
    Vector6d before = Vector6d::Zero();
    int count = 0;
    double last = 0, last_time = poke.at;
    std::optional<double> since;
    for (const truth_contact_t& truth : log_.truth_contacts) {
      const double now = time(truth.utime);
      if (now < poke.at - kBefore || now > poke.at + ramp) continue;
      const Vector6d wrench = at_sensor(truth, X_GS_);
      if (now < poke.at) {
        before += (wrench - before) / ++count;
        continue;
      }
      if (count == 0) throw std::runtime_error("the log does not reach before a poke");
      const double off = deviations(wrench - before);
      if (off <= kDeviations) {
        since.reset();
      } else if (!since) {  // linear interpolation between two messages
        const double share = last < kDeviations ? (kDeviations - last) / (off - last) : 0;
        since = last_time + share * (now - last_time) - poke.at;
      }
      last = off;
      last_time = now;
    }
    return since;
  }

  void score_contact(PokeScore& result) const {
    const scenes::Poke& poke = result.poke;
    const double full = poke.at + poke.duration - std::min(scenes::Poke::kRamp, poke.duration / 2);
    const log::PlantPoints point(plant_, poke.point);
    Eigen::Matrix3Xd truth;
    int count = 0, observable = 0;
    double place = 0;
    Vector3d force = Vector3d::Zero();
    for (const unknown_contact_t& contact : log_.unknown_contacts) {
      const double now = time(contact.utime);
      if (now < full - kWindow || now > full || contact.force_deviation < 0) continue;
      if (!motion_.at(contact.utime, truth)) continue;
      const Eigen::Map<const Vector3d> reported(contact.location);
      place += (reported - X_OP_ * Vector3d(point.at(truth).col(0))).norm();
      force += Eigen::Map<const Vector3d>(contact.force);
      observable += contact.location_deviation >= 0 ? 1 : 0;
      ++count;
    }
    if (count == 0) return;
    result.observable = static_cast<double>(observable) / count;
    result.place = place / count;
    result.force = (force / count - X_OP_.linear() * poke.force).norm();
  }

  void score_shape(PokeScore& result, const std::optional<double>& found_at) const {
    const scenes::Poke& poke = result.poke;
    const double shift = time(log_.shapes.front().utime);
    int count = 0;
    for (const scores::ShapeErrorSample& sample : shape_.samples) {
      const double now = sample.time + shift;
      const PokeScore::Error error{sample.mean, sample.maximum};
      if (now >= poke.at - kBefore && now < poke.at) {
        ++count;
        result.before.mean += (error.mean - result.before.mean) / count;
        result.before.worst += (error.worst - result.before.worst) / count;
      }
      if (now < poke.at || now > poke.at + poke.duration) continue;
      result.largest.mean = std::max(result.largest.mean, error.mean);
      result.largest.worst = std::max(result.largest.worst, error.worst);
      if (!found_at) continue;
      if (now >= *found_at + 0.5 && !result.half_second) result.half_second = error;
      if (now >= *found_at + 1 && !result.second) result.second = error;
    }
    if (count == 0) throw std::runtime_error("the log does not reach before a poke");
  }

  const log::RunLog& log_;
  const scores::ShapeScore& shape_;
  log::MeshMessage plant_;
  log::PlantMotion motion_;
  math::Pose X_GS_, X_OP_;
  std::int64_t start_;
};

bool is_poked(const std::vector<scenes::Poke>& pokes, double time) {
  return std::any_of(pokes.begin(), pokes.end(), [time](const scenes::Poke& poke) {
    return time >= poke.at && time <= poke.at + poke.duration + kLinger;
  });
}

Json json_of(const std::optional<PokeScore::Error>& error, double length) {
  if (!error) return {};
  return {{"mean_percent_of_length", 100 * error->mean / length},
          {"worst_percent_of_length", 100 * error->worst / length}};
}

}  // namespace

PokeScores score_pokes(const std::vector<scenes::Poke>& pokes, const log::RunLog& log,
                       const scores::ShapeScore& shape, const registry::Frames& frames,
                       const math::Pose& X_OP) {
  if (log.truths.empty() || log.shapes.empty() || log.estimates.empty())
    throw std::runtime_error("the log holds no truth or no estimate");
  const Run run(log, shape, frames, X_OP);
  PokeScores result;
  for (const scenes::Poke& poke : pokes) result.pokes.push_back(run.score(poke));
  bool reported = false;
  double last = run.time(log.estimates.front().utime);
  for (const estimate_t& estimate : log.estimates) {
    const double now = run.time(estimate.utime);
    const bool reports = scores::reports_contact(estimate);
    if (!is_poked(pokes, now)) {
      result.quiet += now - last;
      if (reports && !reported) result.false_alarms.push_back(now);
    }
    reported = reports;
    last = now;
  }
  return result;
}

nlohmann::json to_json(const PokeScores& scores, double length) {
  Json json{{"false_alarms", scores.false_alarms.size()},
            {"false_alarms_s", scores.false_alarms},
            {"quiet_s", scores.quiet}};
  json["each"] = Json::array();
  for (const PokeScore& score : scores.pokes) {
    const Vector3d &point = score.poke.point, &force = score.poke.force;
    json["each"].push_back({{"point_m", {point.x(), point.y(), point.z()}},
                            {"force_n", {force.x(), force.y(), force.z()}},
                            {"felt_ms", common::or_null(score.felt, 1e3)},
                            {"found_ms", common::or_null(score.found, 1e3)},
                            {"gone_ms", common::or_null(score.gone, 1e3)},
                            {"place_mm", common::or_null(score.place, 1e3)},
                            {"force_off_n", common::or_null(score.force)},
                            {"observable", common::or_null(score.observable)},
                            {"before", json_of(score.before, length)},
                            {"largest", json_of(score.largest, length)},
                            {"half_second", json_of(score.half_second, length)},
                            {"second", json_of(score.second, length)}});
  }
  return json;
}

}  // namespace palpate::studies
