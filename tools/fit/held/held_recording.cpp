#include "tools/fit/held/held_recording.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::fit {
namespace {

constexpr double kWayStep = 0.01;  // m between poses of a path
constexpr double kWayTurn = 0.08;  // rad

Eigen::Matrix3Xd points_of(const shape_observation_t& seen) {
  return Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>>(&seen.points[0][0], 3,
                                                                   seen.count)
      .cast<double>();
}

/// Points of the messages from `from` to `to`; their standard deviation is accumulated in
/// `deviation`.
Eigen::Matrix3Xd points_between(const std::vector<shape_observation_t>& seen, std::int64_t from,
                                std::int64_t to, bool average, double& deviation) {
  std::vector<const shape_observation_t*> inside;
  for (const shape_observation_t& message : seen)
    if (message.utime >= from && message.utime < to && message.count > 0 && message.count <= 256 &&
        points_of(message).allFinite())
      inside.push_back(&message);
  if (inside.empty()) return {};
  if (!average) {
    deviation = std::max(deviation, inside[inside.size() / 2]->deviation);
    return points_of(*inside[inside.size() / 2]);
  }
  Eigen::Matrix3Xd sum = points_of(*inside[0]);
  for (std::size_t i = 1; i < inside.size(); ++i) {
    if (inside[i]->count != inside[0]->count)
      throw std::runtime_error("SHAPE_OBSERVATION " + std::to_string(inside[i]->seq) + " holds " +
                               std::to_string(inside[i]->count) + " markers, the one before " +
                               std::to_string(inside[0]->count));
    sum += points_of(*inside[i]);
  }
  const auto count = static_cast<double>(inside.size());
  deviation = std::max(deviation, inside[0]->deviation / std::sqrt(count));
  return sum / count;
}

}  // namespace

HeldRecording read_held_recording(const std::string& log, const CalmRule& rule,
                                  const std::string& time, bool average_points) {
  const HeldLog messages = read_held_log(log, rule, time);
  const std::vector<HeldBlock>& blocks = messages.blocks;
  const int settle = static_cast<int>(std::lround(rule.settle / kBlock));
  const int window = std::max(1, static_cast<int>(std::lround(rule.window / kBlock)));
  const int every = std::max(1, static_cast<int>(std::lround(rule.every / kBlock)));

  HeldRecording recording;
  std::vector<math::Pose> way;
  math::Vector6d squares = math::Vector6d::Zero();
  int calm = 0, last = -every, freedom = 0;
  for (int i = 0; i < static_cast<int>(blocks.size()); ++i) {
    if (!blocks[i].whole) {
      calm = 0;
      continue;
    }
    if (way.empty() ||
        (way.back().translation() - blocks[i].X_WE.translation()).norm() > kWayStep ||
        turn_between(way.back(), blocks[i].X_WE) > kWayTurn)
      way.push_back(blocks[i].X_WE);
    calm = blocks[i].calm ? calm + 1 : 0;
    const int first = i - window + 1;
    if (calm < settle + window || first - last < every) continue;
    HeldSample sample;
    PoseMean pose;
    math::Vector6d wrench = math::Vector6d::Zero();
    for (int k = first; k <= i; ++k) {
      pose.add(blocks[k].X_WE);
      wrench += blocks[k].wrench / window;
    }
    for (int k = first; k <= i; ++k) squares += (blocks[k].wrench - wrench).cwiseAbs2();
    freedom += window - 1;
    sample.time = kBlock * (first + 0.5 * window);
    sample.X_WE = pose.get();
    sample.F_S = math::Wrench::from(wrench);
    const auto at = [&](int block) {
      return messages.begin + static_cast<std::int64_t>(1e6 * kBlock * block);
    };
    sample.points_W = points_between(messages.seen, at(first), at(i + 1), average_points,
                                     recording.point_deviation);
    sample.way = way;
    way.clear();
    last = first;
    recording.samples.push_back(std::move(sample));
  }
  if (recording.samples.empty())
    throw std::runtime_error(log + ": the hand is never calm for " +
                             std::to_string(rule.settle + rule.window) +
                             " s; hold it still, or allow more speed or less time");
  recording.deviation =
      freedom > 0 ? (squares / freedom / window).cwiseSqrt().eval() : math::Vector6d::Zero().eval();
  return recording;
}

}  // namespace palpate::fit
