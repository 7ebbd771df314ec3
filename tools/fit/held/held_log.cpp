#include "tools/fit/held/held_log.hpp"

#include <algorithm>
#include <cmath>
#include <palpate/channels.hpp>
#include <stdexcept>

#include "tools/log/log_reader.hpp"

namespace palpate::fit {
namespace {

math::Pose flange_pose(const robot_state_t& state) {
  return math::make_pose(math::rotation_from_wxyz(state.quaternion),
                         Eigen::Map<const Eigen::Vector3d>(state.position));
}

std::vector<HeldBlock> make_blocks(const HeldLog& messages) {
  const std::int64_t end = std::max(messages.robot.back().utime, messages.wrenches.back().utime);
  const auto index = [&](std::int64_t utime) {
    return static_cast<std::size_t>(1e-6 * static_cast<double>(utime - messages.begin) / kBlock);
  };
  std::vector<HeldBlock> blocks(index(end) + 1);
  std::vector<PoseMean> poses(blocks.size());
  std::vector<int> counts(blocks.size(), 0);
  for (const robot_state_t& state : messages.robot)
    if (state.utime >= messages.begin) poses[index(state.utime)].add(flange_pose(state));
  for (const ft_wrench_t& wrench : messages.wrenches) {
    if (wrench.utime < messages.begin) continue;
    blocks[index(wrench.utime)].wrench += Eigen::Map<const math::Vector6d>(wrench.wrench);
    ++counts[index(wrench.utime)];
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    blocks[i].whole = poses[i].count() > 0 && counts[i] > 0;
    if (!blocks[i].whole) continue;
    blocks[i].X_WE = poses[i].get();
    blocks[i].wrench /= counts[i];
  }
  return blocks;
}

void mark_calm(const CalmRule& rule, std::vector<HeldBlock>& blocks) {
  const auto still = [&](const HeldBlock& a, const HeldBlock& b) {
    return a.whole && b.whole &&
           (a.X_WE.translation() - b.X_WE.translation()).norm() < rule.linear_speed * kBlock &&
           turn_between(a.X_WE, b.X_WE) < rule.angular_speed * kBlock;
  };
  for (std::size_t i = 1; i + 1 < blocks.size(); ++i)
    blocks[i].calm = still(blocks[i - 1], blocks[i]) && still(blocks[i], blocks[i + 1]);
}

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

void PoseMean::add(const math::Pose& X) {
  if (count_ == 0) first_ = X;
  translation_ += X.translation();
  turn_ += math::log_rotation(X.linear() * first_.linear().transpose());
  ++count_;
}

math::Pose PoseMean::get() const {
  return math::make_pose(math::exp_rotation(turn_ / count_) * first_.linear(),
                         translation_ / count_);
}

double turn_between(const math::Pose& a, const math::Pose& b) {
  return math::log_rotation(a.linear().transpose() * b.linear()).norm();
}

HeldLog read_held_log(const std::string& log, const CalmRule& rule, const std::string& time) {
  HeldLog messages;
  log::LogReader reader(time == "sent" ? log::LogClock::kSent : log::LogClock::kReceived);
  reader.collect(channel::kRobotState, messages.robot);
  reader.collect(channel::kFtWrench, messages.wrenches);
  reader.collect(channel::kShapeObservation, messages.seen);
  reader.read(log);
  if (messages.robot.empty())
    throw std::runtime_error(log + ": holds no ROBOT_STATE; record the channel of the arm too");
  if (messages.wrenches.empty())
    throw std::runtime_error(log + ": holds no FT_WRENCH; record the channel of the wrist too");
  for (const robot_state_t& state : messages.robot)
    if (!math::is_unit_quaternion(state.quaternion) ||
        !Eigen::Map<const Eigen::Vector3d>(state.position).allFinite())
      throw std::runtime_error(log + ": ROBOT_STATE " + std::to_string(state.seq) +
                               " holds no pose; correct the driver or cut the log");
  for (const ft_wrench_t& wrench : messages.wrenches)
    if (!Eigen::Map<const math::Vector6d>(wrench.wrench).allFinite())
      throw std::runtime_error(log + ": FT_WRENCH " + std::to_string(wrench.seq) +
                               " is not finite; correct the driver or cut the log");
  constexpr std::int64_t kLongest = 86'400'000'000;  // us
  const std::int64_t end = std::max(messages.robot.back().utime, messages.wrenches.back().utime);
  messages.begin = std::max(messages.robot[0].utime, messages.wrenches[0].utime);
  if (end < messages.begin || end - messages.begin > kLongest)
    throw std::runtime_error(log +
                             ": its times do not span between nothing and a day; read it by "
                             "the other clock (time: sent, received)");
  messages.blocks = make_blocks(messages);
  mark_calm(rule, messages.blocks);
  return messages;
}

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
