#include "tools/lab/scores/shape_score.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/lab/scores/truth_points.hpp"

namespace palpate::scores {
namespace {

constexpr double kStillSpeed = 2e-3;         // m/s
constexpr double kStillRate = 2e-2;          // rad/s
constexpr std::int64_t kSpeedBase = 100000;  // us, over which speed is computed
constexpr double kLeastHold = 1.0;           // s
constexpr double kHoldEnd = 0.5;             // s, scored at the end of a hold

math::Pose grasp_pose(const truth_contact_t& contact) {
  return math::make_pose(math::rotation_from_wxyz(contact.grasp_quaternion[0]),
                         Eigen::Map<const Eigen::Vector3d>(contact.grasp_position[0]));
}

double seconds(std::int64_t microseconds) { return static_cast<double>(microseconds) * 1e-6; }

/// Samples outside of all holds of a run that started at `start`, us.
std::vector<ShapeErrorSample> moving(const std::vector<ShapeErrorSample>& samples,
                                     const std::vector<Interval>& holds, std::int64_t start) {
  std::vector<ShapeErrorSample> kept;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(kept), [&](const auto& sample) {
    return std::none_of(holds.begin(), holds.end(), [&](const Interval& hold) {
      return seconds(hold.begin - start) <= sample.time && sample.time <= seconds(hold.end - start);
    });
  });
  return kept;
}

}  // namespace

ErrorSummary summarise(const std::vector<ShapeErrorSample>& samples, std::size_t first,
                       std::size_t last) {
  ErrorSummary summary;
  if (first >= last) return summary;
  double squares = 0;
  for (std::size_t i = first; i < last; ++i) {
    summary.mean += samples[i].mean;
    squares += samples[i].rms * samples[i].rms;
    summary.maximum = std::max(summary.maximum, samples[i].maximum);
  }
  const double count = static_cast<double>(last - first);
  summary.mean /= count;
  summary.rms = std::sqrt(squares / count);
  return summary;
}

ErrorSummary ShapeScore::at_holds() const {
  if (holds.empty()) return whole;
  ErrorSummary summary;
  double squares = 0;
  for (const HoldScore& hold : holds) {
    summary.mean += hold.error.mean / static_cast<double>(holds.size());
    squares += hold.error.rms * hold.error.rms / static_cast<double>(holds.size());
    summary.maximum = std::max(summary.maximum, hold.error.maximum);
  }
  summary.rms = std::sqrt(squares);
  return summary;
}

double ShapeScore::median_hold() const {
  if (holds.empty()) return whole.mean;
  std::vector<double> means;
  for (const HoldScore& hold : holds) means.push_back(hold.error.mean);
  std::sort(means.begin(), means.end());
  return 0.5 * (means[(means.size() - 1) / 2] + means[means.size() / 2]);
}

std::vector<Interval> find_holds(const std::vector<truth_contact_t>& contacts, double least) {
  std::vector<Interval> holds;
  std::size_t before = 0;
  bool still_before = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].grasp_count < 1) continue;
    while (contacts[i].utime - contacts[before].utime > kSpeedBase) ++before;
    const double dt = seconds(contacts[i].utime - contacts[before].utime);
    if (dt < 0.5 * seconds(kSpeedBase)) continue;
    const math::Pose motion = grasp_pose(contacts[before]).inverse() * grasp_pose(contacts[i]);
    const bool still = motion.translation().norm() < kStillSpeed * dt &&
                       math::log_rotation(motion.linear()).norm() < kStillRate * dt;
    if (still && !still_before) holds.push_back({contacts[before].utime, contacts[i].utime});
    if (still) holds.back().end = contacts[i].utime;
    still_before = still;
  }
  holds.erase(std::remove_if(
                  holds.begin(), holds.end(),
                  [least](const Interval& hold) { return seconds(hold.end - hold.begin) < least; }),
              holds.end());
  return holds;
}

ShapeScore score_shape(const log::RunLog& run, const math::Pose& X_OP) {
  if (run.shapes.empty()) throw std::runtime_error("the log holds no SHAPE");
  if (run.truths.empty()) throw std::runtime_error("the log holds no TRUTH_SHAPE");
  const log::MeshMessage estimate = log::assemble(run.shape_chunks);
  const log::MeshMessage plant = log::assemble(run.truth_chunks);
  const TruthPoints points(plant, estimate, estimate.nodes, X_OP);
  const log::PlantMotion motion(run.truths);
  const std::int64_t start = run.shapes.front().utime;

  ShapeScore score;
  score.length = plant.longest_side();
  Eigen::Matrix3Xd plant_positions;
  for (const shape_t& shape : run.shapes) {
    if (shape.mesh_hash != estimate.hash || shape.node_count != estimate.nodes.cols()) continue;
    if (!motion.at(shape.utime, plant_positions) || plant_positions.cols() != plant.nodes.cols())
      continue;
    const Eigen::VectorXd distance =
        (log::positions(shape) - points.at(plant_positions)).colwise().norm();
    ShapeErrorSample sample;
    sample.time = seconds(shape.utime - start);
    sample.mean = distance.mean();
    sample.rms = std::sqrt(distance.squaredNorm() / static_cast<double>(distance.size()));
    sample.maximum = distance.maxCoeff();
    sample.displacement = (plant_positions - plant.nodes).colwise().norm().maxCoeff();
    if (!std::isfinite(sample.rms)) throw std::runtime_error("a shape that is not finite");
    score.samples.push_back(sample);
    score.largest_displacement = std::max(score.largest_displacement, sample.displacement);
    ++score.shapes;
    if (shape.status != shape_t::STATUS_CURRENT) ++score.not_current;
  }
  if (score.samples.empty()) throw std::runtime_error("no SHAPE at a time that the truth covers");
  score.whole = summarise(score.samples, 0, score.samples.size());

  const std::vector<Interval> holds = find_holds(run.truth_contacts, kLeastHold);
  const std::vector<ShapeErrorSample> motion_samples = moving(score.samples, holds, start);
  score.in_motion = summarise(motion_samples, 0, motion_samples.size());
  for (std::size_t h = 0; h < holds.size(); ++h) {
    HoldScore hold;
    hold.begin = seconds(holds[h].begin - start);
    hold.end = seconds(holds[h].end - start);
    if (h == 0 && hold.begin < 0.5) continue;  // initial pose, before any motion
    const auto index = [&score](double time) {
      return static_cast<std::size_t>(
          std::lower_bound(score.samples.begin(), score.samples.end(), time,
                           [](const ShapeErrorSample& s, double t) { return s.time < t; }) -
          score.samples.begin());
    };
    const std::size_t first = index(hold.end - kHoldEnd), last = index(hold.end);
    if (first >= last) continue;
    hold.error = summarise(score.samples, first, last);
    hold.displacement = score.samples[last - 1].displacement;
    score.holds.push_back(hold);
  }
  return score;
}

}  // namespace palpate::scores
