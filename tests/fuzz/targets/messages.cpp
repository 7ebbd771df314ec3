// Messages of all input channels of the daemon, with arbitrary bytes as values: each is one byte
// for the channel, one of flags, and the content after the fingerprint.

#include <algorithm>
#include <cmath>
#include <palpate/biotac_t.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/fingertip_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/sim_tick_t.hpp>
#include <palpate/touch_request_t.hpp>

#include "rt/daemon/inputs.hpp"
#include "tests/fuzz/target.hpp"

namespace palpate::fuzz {
namespace {

struct Kind {
  const char* channel;
  int size;  // encoded
  std::int64_t fingerprint;
};

template <class Message>
Kind kind(const char* channel) {
  return {channel, Message().getEncodedSize(), Message::getHash()};
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {kind<ft_wrench_t>("FT_WRENCH"),
                                        kind<imu_t>("IMU"),
                                        kind<robot_state_t>("ROBOT_STATE"),
                                        kind<hand_state_t>("HAND_STATE"),
                                        kind<ft_wrench_t>("FT_WRENCH_1"),
                                        kind<imu_t>("IMU_1"),
                                        kind<robot_state_t>("ROBOT_STATE_1"),
                                        kind<hand_state_t>("HAND_STATE_1"),
                                        kind<manual_force_t>("MANUAL_FORCE"),
                                        kind<biotac_t>("BIOTAC_0"),
                                        kind<biotac_t>("BIOTAC_4"),
                                        kind<component_command_t>("COMPONENT_COMMAND"),
                                        kind<shape_target_t>("SHAPE_TARGET"),
                                        kind<sim_tick_t>("SIM_TICK"),
                                        kind<shape_observation_t>("SHAPE_OBSERVATION"),
                                        kind<touch_request_t>("TOUCH_REQUEST"),
                                        kind<fingertip_t>("FINGERTIP_0")};
  return all;
}

constexpr int kWrongFingerprint = 1, kWrongSize = 2, kTick = 4;

template <class Message>
std::string seed(int index, Message message, int flags = kTick) {
  std::vector<char> bytes(message.getEncodedSize());
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return std::string{static_cast<char>(index), static_cast<char>(flags)} +
         std::string(bytes.begin() + 8, bytes.end());
}

/// Whether the generated code reproduces the given bytes.
template <class Message>
struct Echo {
  Echo(bus::MessageBus& bus, const char* channel) : queue(bus, channel, 4) {}
  void check() {
    Message message{};
    std::int64_t arrival_ns = 0;
    while (queue.take(message, arrival_ns)) {
      std::vector<std::uint8_t> bytes(message.getEncodedSize());
      require(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) ==
                  static_cast<int>(bytes.size()),
              "what was decoded can be encoded");
    }
  }
  bus::TypedSubscription<Message> queue;
};

bool is_pose(const math::Pose& pose) {
  return pose.matrix().allFinite() && (pose.linear() * pose.linear().transpose()).isIdentity(1e-6);
}

void check(const sensing::Signals& signals) {
  const sensing::RobotState& robot = signals.robot.latest;
  require(signals.force_torque.latest.F_S.force.allFinite() &&
              signals.force_torque.latest.F_S.torque.allFinite(),
          "force-torque is finite");
  require(signals.inertial.latest.acceleration_I.allFinite() &&
              signals.inertial.latest.angular_velocity_I.allFinite(),
          "inertial is finite");
  require(robot.joint_count >= 0 && robot.joint_count <= 16, "joint count");
  require(robot.q.head(robot.joint_count).allFinite() &&
              robot.dq.head(robot.joint_count).allFinite() && robot.V_W_E.linear.allFinite() &&
              robot.V_W_E.angular.allFinite(),
          "joints and twist are finite");
  require(is_pose(robot.X_WE), "the flange's pose is one");
  const sensing::HandState& hand = signals.hand.latest;
  require(hand.fingertip_count >= 0 && hand.fingertip_count <= 5, "fingertip count");
  for (int i = 0; i < hand.fingertip_count; ++i) require(is_pose(hand.X_ET[i]), "fingertip's pose");
  require(
      signals.manual.latest.force_O.allFinite() && signals.manual.latest.rest_point_O.allFinite(),
      "manual force is finite");
  const sensing::FingertipContact& tip = signals.fingertip[0].latest;
  require(tip.place_T.allFinite() && tip.normal_T.allFinite() && tip.force_T.allFinite() &&
              (!tip.touches || std::abs(tip.normal_T.norm() - 1) < 1e-9),
          "the fingertip's contact is finite");
  const sensing::ShapeObservation& seen = signals.observation.latest;
  require(seen.count >= 0 && seen.count <= sensing::ShapeObservation::kMostPoints, "point count");
  require(seen.points_W.leftCols(seen.count).allFinite() && seen.deviation >= 0 &&
              std::isfinite(seen.deviation),
          "what is seen is finite");
}

}  // namespace

std::vector<std::string> seeds() {
  robot_state_t robot{};
  robot.joint_count = 7;
  robot.quaternion[0] = 1;
  hand_state_t hand{};
  hand.fingertip_count = 1;
  hand.fingertip_quaternion[0][0] = 1;
  biotac_t touch{};
  touch.valid = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC;
  touch.pac_count = 22;
  fingertip_t tip{};
  tip.contact = 1;
  tip.normal[2] = 1;
  shape_observation_t cloud{};
  cloud.count = 3;
  cloud.deviation = 1e-3;
  ft_wrench_t first{}, second{};
  first.session = second.session = 7;
  second.seq = 1;
  return {seed(0, first) + seed(0, second) + seed(4, second),
          seed(1, imu_t{}),
          seed(2, robot) + seed(6, robot),
          seed(3, hand) + seed(7, hand, 0),
          seed(8, manual_force_t{}),
          seed(9, touch) + seed(10, touch),
          seed(11, component_command_t{}) + seed(13, sim_tick_t{}),
          seed(12, shape_target_t{}),
          seed(14, cloud),
          seed(15, touch_request_t{}),
          seed(16, tip),
          seed(1, imu_t{}, kWrongFingerprint) + seed(2, robot, kWrongSize)};
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const auto hub = bus::make_memory_hub();
  const auto bus = bus::make_memory_bus(hub), sender = bus::make_memory_bus(hub);
  daemon::Inputs inputs(*bus, 2);
  fuzz::Echo<component_command_t> commands(*bus, "COMPONENT_COMMAND");
  fuzz::Echo<shape_target_t> targets(*bus, "SHAPE_TARGET");
  fuzz::Echo<touch_request_t> touches(*bus, "TOUCH_REQUEST");
  fuzz::Echo<sim_tick_t> ticks(*bus, "SIM_TICK");

  std::int64_t now_ns = 0;
  while (size >= 2) {
    const fuzz::Kind& kind = fuzz::kinds()[data[0] % fuzz::kinds().size()];
    const int flags = data[1];
    data += 2;
    size -= 2;
    std::vector<std::uint8_t> bytes(kind.size);
    for (int i = 0; i < 8; ++i)
      bytes[i] =
          static_cast<std::uint8_t>(static_cast<std::uint64_t>(kind.fingerprint) >> (56 - 8 * i));
    const std::size_t content = std::min(size, bytes.size() - 8);
    std::copy_n(data, content, bytes.begin() + 8);
    data += content;
    size -= content;
    if (flags & fuzz::kWrongFingerprint) bytes[3] ^= 1;
    if (flags & fuzz::kWrongSize) bytes.pop_back();
    bus::set_time(*hub, now_ns += 1'000'000);
    sender->publish(kind.channel, bytes.data(), static_cast<int>(bytes.size()));
    if (!(flags & fuzz::kTick)) continue;
    inputs.read(now_ns, 1e-3);
    fuzz::check(inputs.signals(0));
    fuzz::check(inputs.signals(1));
  }
  inputs.read(now_ns, 1e-3);
  fuzz::check(inputs.signals(0));
  fuzz::check(inputs.signals(1));
  commands.check();
  targets.check();
  touches.check();
  ticks.check();
  for (int i = 0; i < inputs.channel_count(); ++i)
    fuzz::require(inputs.report(i).received >= 0 && inputs.report(i).rejected >= 0, "counters");
  return 0;
}
