#include "rt/daemon/inputs.hpp"

#include <cmath>
#include <palpate/channels.hpp>

namespace palpate::daemon {
namespace {

// Per channel; bounds the work per cycle under a message flood.
constexpr int kMostPerCycle = 64;

constexpr std::array<const char*, 5> kBiotacChannels = {
    channel::kBiotac0, channel::kBiotac1, channel::kBiotac2, channel::kBiotac3, channel::kBiotac4};

/// By arm: force-torque, IMU, robot, hand.
constexpr std::array<std::array<const char*, 4>, 2> kArmChannels = {
    {{channel::kFtWrench, channel::kImu, channel::kRobotState, channel::kHandState},
     {channel::kFtWrench1, channel::kImu1, channel::kRobotState1, channel::kHandState1}}};

/// Larger than any force, speed and length of a robot cell in SI units, hence not a measurement.
/// Larger finite numbers would overflow when squared.
constexpr double kLargest = 1e6;

bool all_plausible(const double* numbers, int count) noexcept {
  for (int i = 0; i < count; ++i) {
    if (!(std::abs(numbers[i]) <= kLargest)) return false;
  }
  return true;
}

double seconds(std::int64_t utime) noexcept { return static_cast<double>(utime) * 1e-6; }

bool convert(const ft_wrench_t& m, sensing::ForceTorque& out) noexcept {
  if (!all_plausible(m.wrench, 6)) return false;
  out.time = seconds(m.utime);
  out.F_S = math::Wrench::from(Eigen::Map<const math::Vector6d>(m.wrench));
  return true;
}

bool convert(const imu_t& m, sensing::Inertial& out) noexcept {
  if (!all_plausible(m.acceleration, 3) || !all_plausible(m.angular_velocity, 3)) return false;
  out.time = seconds(m.utime);
  out.acceleration_I = Eigen::Map<const Eigen::Vector3d>(m.acceleration);
  out.angular_velocity_I = Eigen::Map<const Eigen::Vector3d>(m.angular_velocity);
  return true;
}

bool convert(const robot_state_t& m, sensing::RobotState& out) noexcept {
  if (m.joint_count < 0 || m.joint_count > 16 || !all_plausible(m.q, m.joint_count) ||
      !all_plausible(m.dq, m.joint_count) || !all_plausible(m.position, 3) ||
      !all_plausible(m.twist, 6) || !math::is_unit_quaternion(m.quaternion)) {
    return false;
  }
  out.time = seconds(m.utime);
  out.joint_count = m.joint_count;
  out.q = Eigen::Map<const Eigen::Matrix<double, 16, 1>>(m.q);
  out.dq = Eigen::Map<const Eigen::Matrix<double, 16, 1>>(m.dq);
  out.X_WE.linear() = math::rotation_from_wxyz(m.quaternion);
  out.X_WE.translation() = Eigen::Map<const Eigen::Vector3d>(m.position);
  out.V_W_E = math::Twist::from(Eigen::Map<const math::Vector6d>(m.twist));
  return true;
}

bool convert(const hand_state_t& m, sensing::HandState& out) noexcept {
  if (m.fingertip_count < 0 || m.fingertip_count > 5 || m.grasp < hand_state_t::GRASP_NONE ||
      m.grasp > hand_state_t::GRASP_SLIPPING) {
    return false;
  }
  for (int i = 0; i < m.fingertip_count; ++i) {
    if (!all_plausible(m.fingertip_position[i], 3) ||
        !math::is_unit_quaternion(m.fingertip_quaternion[i])) {
      return false;
    }
    out.X_ET[i].linear() = math::rotation_from_wxyz(m.fingertip_quaternion[i]);
    out.X_ET[i].translation() = Eigen::Map<const Eigen::Vector3d>(m.fingertip_position[i]);
  }
  out.time = seconds(m.utime);
  out.grasp = static_cast<sensing::Grasp>(m.grasp);
  out.fingertip_count = m.fingertip_count;
  return true;
}

bool convert(const manual_force_t& m, sensing::ManualForce& out) noexcept {
  if (!all_plausible(m.rest_point, 3) || !all_plausible(m.force, 3)) return false;
  out.rest_point_O = Eigen::Map<const Eigen::Vector3d>(m.rest_point);
  out.force_O = Eigen::Map<const Eigen::Vector3d>(m.force);
  return true;
}

bool convert(const biotac_t& m, sensing::BioTac& out) noexcept {
  constexpr int kNeeded = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC;
  if ((m.valid & kNeeded) != kNeeded || m.pac_count < 1 || m.pac_count > 22) return false;
  out.time = seconds(m.utime);
  for (int i = 0; i < 19; ++i) out.electrodes[i] = m.electrodes[i];
  out.pac = m.pac[0];
  out.pdc = m.pdc;
  out.tac = m.tac;
  out.tdc = m.tdc;
  return true;
}

/// A camera that does not see the object publishes zero points: no information on the shape, but a
/// sign of life.
bool convert(const shape_observation_t& m, sensing::ShapeObservation& out) noexcept {
  constexpr double kCoarsest = 1;  // m, largest plausible deviation
  if (m.count < 0 || m.count > sensing::ShapeObservation::kMostPoints) return false;
  if (m.count > 0 && !(m.deviation > 0 && m.deviation <= kCoarsest)) return false;
  for (int i = 0; i < m.count; ++i) {
    for (const float x : m.points[i]) {
      if (!(std::abs(x) <= static_cast<float>(kLargest))) return false;
    }
    out.points_W.col(i) = Eigen::Map<const Eigen::Vector3f>(m.points[i]);
  }
  out.time = seconds(m.utime);
  out.count = m.count;
  out.deviation = m.deviation;
  return true;
}

constexpr auto kConvert = [](const auto& message, auto& out) noexcept {
  return convert(message, out);
};

/// True if two samples have the same values, whatever their times.
bool same(const sensing::ForceTorque& a, const sensing::ForceTorque& b) noexcept {
  return a.F_S.force == b.F_S.force && a.F_S.torque == b.F_S.torque;
}
bool same(const sensing::Inertial& a, const sensing::Inertial& b) noexcept {
  return a.acceleration_I == b.acceleration_I && a.angular_velocity_I == b.angular_velocity_I;
}
bool same(const sensing::RobotState& a, const sensing::RobotState& b) noexcept {
  return a.q == b.q && a.dq == b.dq && a.X_WE.matrix() == b.X_WE.matrix() &&
         a.V_W_E.linear == b.V_W_E.linear && a.V_W_E.angular == b.V_W_E.angular;
}
bool same(const sensing::BioTac& a, const sensing::BioTac& b) noexcept {
  return a.electrodes == b.electrodes && a.pac == b.pac && a.pdc == b.pdc && a.tac == b.tac &&
         a.tdc == b.tdc;
}
template <class Sample>
bool same(const Sample&, const Sample&) noexcept {
  return false;
}

}  // namespace

Inputs::ArmChannels::ArmChannels(bus::MessageBus& bus, const std::array<const char*, 4>& names,
                                 const FrozenAfter& frozen_after)
    : force_torque(bus, names[0], 64, frozen_after.force_torque),
      inertial(bus, names[1], 32, frozen_after.inertial),
      robot(bus, names[2], 32, frozen_after.robot),
      hand(bus, names[3], 8) {
  force_torque.lock_to_first_publisher();
  inertial.lock_to_first_publisher();
  robot.lock_to_first_publisher();
  hand.lock_to_first_publisher();
}

Inputs::Inputs(bus::MessageBus& control, int arms, const FrozenAfter& frozen_after,
               const bus::Access& access)
    : first_(control, kArmChannels[0], frozen_after),
      second_(arms > 1 ? std::make_unique<ArmChannels>(control, kArmChannels[1], frozen_after)
                       : nullptr),
      manual_(control, channel::kManualForce, 8),
      manual_admission_(channel::kManualForce, access),
      observation_(control, channel::kShapeObservation, 4) {
  observation_.lock_to_first_publisher();
  for (std::size_t i = 0; i < biotac_.size(); ++i) {
    biotac_[i] =
        std::make_unique<Channel<biotac_t>>(control, kBiotacChannels[i], 8, frozen_after.biotac);
    biotac_[i]->lock_to_first_publisher();
  }
}

template <class Message, class Sample>
bool Inputs::is_frozen(Channel<Message>& channel, const Sample& before, const Sample& now,
                       std::int64_t arrival_ns) noexcept {
  constexpr int kRepeats = 10;  // minimum count, so that a gap between two messages does not count
  if (channel.frozen_after_ns == 0 || !same(before, now)) {
    channel.changed_ns = arrival_ns;
    channel.repeats = 0;
    return false;
  }
  ++channel.repeats;
  return channel.repeats >= kRepeats && arrival_ns - channel.changed_ns > channel.frozen_after_ns;
}

template <class Message>
bool Inputs::admitted(const Message& message) noexcept {
  if constexpr (std::is_same_v<Message, manual_force_t>) {
    return manual_admission_.judge(message) == bus::Admitted::kFresh;
  }
  return true;
}

template <class Message, class Stream, class Convert>
void Inputs::drain(Channel<Message>& channel, Stream& stream, std::int64_t now_ns, bool stepped,
                   Convert to_signal) noexcept {
  stream.fresh_count = 0;
  channel.session_restarted = false;
  std::int64_t arrival_ns = 0;
  for (int i = 0; i < kMostPerCycle && channel.queue.take(channel.message, arrival_ns); ++i) {
    if (!admitted(channel.message)) {
      ++channel.invalid;
      continue;
    }
    if (!channel.sequence.accept(channel.message.session, channel.message.seq)) continue;
    if (channel.sequence.sessions() > channel.sessions) {
      channel.session_restarted = channel.sessions > 0;
      channel.sessions = channel.sequence.sessions();
    }
    auto candidate = stream.latest;
    if (!to_signal(channel.message, candidate)) {
      ++channel.invalid;
      continue;
    }
    if (stepped) arrival_ns = now_ns;
    if (is_frozen(channel, stream.latest, candidate, arrival_ns)) {
      ++channel.frozen;
      continue;
    }
    stream.latest = candidate;
    channel.arrival_ns = arrival_ns;
    if (stream.fresh_count < static_cast<int>(stream.fresh.size())) {
      stream.fresh[stream.fresh_count++] = stream.latest;
    } else {  // keep the newest
      std::move(stream.fresh.begin() + 1, stream.fresh.end(), stream.fresh.begin());
      stream.fresh.back() = stream.latest;
    }
    stream.freshness = Freshness::kNew;
  }
  if (stream.freshness == Freshness::kNoData) return;
  if (stream.fresh_count == 0) stream.freshness = Freshness::kOld;
  stream.age = static_cast<double>(now_ns - channel.arrival_ns) * 1e-9;
  channel.age = stream.age;
}

void Inputs::drain(ArmChannels& arm, sensing::Signals& signals, std::int64_t now_ns,
                   bool stepped) noexcept {
  drain(arm.force_torque, signals.force_torque, now_ns, stepped, kConvert);
  drain(arm.inertial, signals.inertial, now_ns, stepped, kConvert);
  drain(arm.robot, signals.robot, now_ns, stepped, kConvert);
  drain(arm.hand, signals.hand, now_ns, stepped, kConvert);
}

void Inputs::read(std::int64_t now_ns, double dt, bool stepped) noexcept {
  for (sensing::Signals& signals : signals_) signals.dt = dt;
  drain(first_, signals_[0], now_ns, stepped);
  if (second_) drain(*second_, signals_[1], now_ns, stepped);
  drain(manual_, signals_[0].manual, now_ns, stepped, kConvert);
  for (std::size_t i = 0; i < biotac_.size(); ++i) {
    drain(*biotac_[i], signals_[0].biotac[i], now_ns, stepped, kConvert);
  }
  drain(observation_, signals_[0].observation, now_ns, stepped, kConvert);
}

bool Inputs::any_session_restarted() const noexcept {
  const auto session_restarted = [](const ArmChannels& arm) {
    return arm.force_torque.session_restarted || arm.inertial.session_restarted ||
           arm.robot.session_restarted || arm.hand.session_restarted;
  };
  return session_restarted(first_) || (second_ && session_restarted(*second_));
}

template <class Message>
InputReport Inputs::report_of(const Channel<Message>& channel) noexcept {
  const bus::SubscriptionCounters& queue = channel.queue.counters();
  InputReport report;
  report.name = channel.name;
  report.received = queue.received;
  report.lost = channel.sequence.lost() + queue.dropped;
  report.rejected = queue.wrong_size + queue.wrong_type + queue.other_sender +
                    channel.sequence.rejected() + channel.invalid;
  report.frozen = channel.frozen;
  report.age = channel.age;
  return report;
}

InputReport Inputs::report_of(const ArmChannels& arm, int channel) noexcept {
  switch (channel) {
    case 0:
      return report_of(arm.force_torque);
    case 1:
      return report_of(arm.inertial);
    case 2:
      return report_of(arm.robot);
    default:
      return report_of(arm.hand);
  }
}

InputReport Inputs::report(int channel) const noexcept {
  if (channel < 4) return report_of(first_, channel);
  if (channel == 4) return report_of(manual_);
  if (channel < 10) return report_of(*biotac_[channel - 5]);
  if (channel == 10) return report_of(observation_);
  return report_of(*second_, channel - 11);
}

}  // namespace palpate::daemon
