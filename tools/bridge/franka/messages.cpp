#include "messages.hpp"

#include <cstring>

#include "tools/bridge/common/franka_modes.hpp"

namespace palpate::franka_bridge {
namespace {

// Offsets in a state, bytes. Its numbers are floats.
constexpr int kX_FE = 136, kX_EK = 200, kEndEffectorMass = 392, kLoadMass = 444;
constexpr int kTauJ = 512, kQ = 596, kDq = 652, kDqD = 680, kDdqD = 708, kTauExt = 840, kF_K = 892;
constexpr int kGenerator = 1288, kReflexReason = 1331, kMode = 1372;
// Offsets in a command, bytes. Its numbers are doubles.
constexpr int kDqC = 64, kMotionFinished = 313;

constexpr int kMoveSize = 113;  // bytes of a request without its header
// Deviations beyond which the arm ends a motion, those of libfranka: translation m, rotation rad,
// elbow rad.
constexpr std::array<double, 3> kDeviation{10, 3.12, 6.283185307179586};

template <std::size_t kSize>
void read_floats(const std::uint8_t* data, std::array<double, kSize>& numbers) {
  for (std::size_t i = 0; i < kSize; ++i) {
    float number = 0;
    std::memcpy(&number, data + 4 * i, 4);
    numbers[i] = number;
  }
}

std::vector<std::uint8_t> request(Request kind, std::uint32_t number, int payload) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(kHeaderSize + payload));
  const std::array<std::uint32_t, 3> header{static_cast<std::uint32_t>(kind), number,
                                            static_cast<std::uint32_t>(bytes.size())};
  std::memcpy(bytes.data(), header.data(), kHeaderSize);
  return bytes;
}

constexpr std::array<const char*, kErrors> kErrorNames{
    "joint_position_limits_violation",
    "cartesian_position_limits_violation",
    "self_collision_avoidance_violation",
    "joint_velocity_violation",
    "cartesian_velocity_violation",
    "force_control_safety_violation",
    "joint_reflex",
    "cartesian_reflex",
    "max_goal_pose_deviation_violation",
    "max_path_pose_deviation_violation",
    "cartesian_velocity_profile_safety_violation",
    "joint_position_motion_generator_start_pose_invalid",
    "joint_motion_generator_position_limits_violation",
    "joint_motion_generator_velocity_limits_violation",
    "joint_motion_generator_velocity_discontinuity",
    "joint_motion_generator_acceleration_discontinuity",
    "cartesian_position_motion_generator_start_pose_invalid",
    "cartesian_motion_generator_elbow_limit_violation",
    "cartesian_motion_generator_velocity_limits_violation",
    "cartesian_motion_generator_velocity_discontinuity",
    "cartesian_motion_generator_acceleration_discontinuity",
    "cartesian_motion_generator_elbow_sign_inconsistent",
    "cartesian_motion_generator_start_elbow_invalid",
    "force_controller_desired_force_tolerance_violation",
    "start_elbow_sign_inconsistent",
    "communication_constraints_violation",
    "power_limit_violation",
    "cartesian_motion_generator_joint_position_limits_violation",
    "cartesian_motion_generator_joint_velocity_limits_violation",
    "cartesian_motion_generator_joint_velocity_discontinuity",
    "cartesian_motion_generator_joint_acceleration_discontinuity",
    "cartesian_position_motion_generator_invalid_frame",
    "controller_torque_discontinuity",
    "joint_p2p_insufficient_torque_for_planning",
    "tau_j_range_violation",
    "instability_detected",
    "joint_move_in_wrong_direction",
    "cartesian_spline_motion_generator_violation",
    "joint_via_motion_generator_planning_joint_limit_violation",
    "base_acceleration_initialization_timeout",
    "base_acceleration_invalid_reading"};

}  // namespace

void read_state(const std::uint8_t* data, RobotState& state) {
  std::memcpy(&state.id, data, 8);
  read_floats(data + kQ, state.q);
  read_floats(data + kDq, state.dq);
  read_floats(data + kDqD, state.dq_d);
  read_floats(data + kDdqD, state.ddq_d);
  read_floats(data + kTauJ, state.tau_J);
  read_floats(data + kTauExt, state.tau_ext);
  read_floats(data + kF_K, state.F_K);
  read_floats(data + kX_FE, state.X_FE);
  read_floats(data + kX_EK, state.X_EK);
  std::array<double, 1> mass{};
  read_floats(data + kEndEffectorMass, mass);
  state.load = mass[0];
  read_floats(data + kLoadMass, mass);
  state.load += mass[0];
  state.generator = data[kGenerator];
  const std::uint8_t mode = data[kMode];
  state.mode = mode <= static_cast<std::uint8_t>(RobotMode::kAutomaticErrorRecovery)
                   ? static_cast<RobotMode>(mode)
                   : RobotMode::kOther;
  for (std::size_t i = 0; i < kErrors; ++i) state.reflex_reason[i] = data[kReflexReason + i] != 0;
}

void write_command(std::uint64_t id, const Seven& dq, bool is_last, std::uint8_t* data) {
  std::memset(data, 0, kCommandSize);
  std::memcpy(data, &id, 8);
  std::memcpy(data + kDqC, dq.data(), sizeof(dq));
  data[kMotionFinished] = is_last ? 1 : 0;
}

std::vector<std::uint8_t> connect_request(std::uint32_t number, std::uint16_t udp_port) {
  std::vector<std::uint8_t> bytes = request(Request::kConnect, number, 4);
  std::memcpy(bytes.data() + kHeaderSize, &kFciVersion, 2);
  std::memcpy(bytes.data() + kHeaderSize + 2, &udp_port, 2);
  return bytes;
}

/// The asynchronous generator and its velocities remain off and zero.
std::vector<std::uint8_t> move_request(std::uint32_t number) {
  std::vector<std::uint8_t> bytes = request(Request::kMove, number, kMoveSize);
  const std::array<std::uint32_t, 2> modes{0, 1};  // joint impedance, joint velocities
  std::uint8_t* at = bytes.data() + kHeaderSize;
  std::memcpy(at, modes.data(), 8);
  std::memcpy(at + 8, kDeviation.data(), 24);
  std::memcpy(at + 32, kDeviation.data(), 24);
  return bytes;
}

std::vector<std::uint8_t> recovery_request(std::uint32_t number) {
  return request(Request::kAutomaticErrorRecovery, number, 0);
}

Header read_header(const std::uint8_t* data) {
  std::array<std::uint32_t, 3> numbers{};
  std::memcpy(numbers.data(), data, kHeaderSize);
  return {numbers[0], numbers[1], numbers[2]};
}

std::string move_status_name(std::uint8_t status) {
  constexpr std::array<const char*, 12> kNames{"success",
                                               "started",
                                               "preempted",
                                               "preempted by a safety function",
                                               "rejected by a safety function",
                                               "rejected: not possible now",
                                               "rejected: the arm is at a singular pose",
                                               "rejected: an argument is invalid",
                                               "aborted by a reflex",
                                               "aborted by the user stop",
                                               "aborted by an input error",
                                               "aborted"};
  return status < kNames.size() ? kNames[status] : "status " + std::to_string(status);
}

std::string names_of(const std::array<bool, kErrors>& errors) {
  std::string names;
  for (std::size_t i = 0; i < kErrors; ++i)
    if (errors[i]) names += (names.empty() ? "" : ", ") + std::string(kErrorNames[i]);
  return names;
}

const char* halt_of(RobotMode mode) noexcept {
  if (mode == RobotMode::kOther)
    return "the arm is not ready (brakes locked, or not in its execution mode)";
  return bridge::halt_of_franka(static_cast<int>(mode));
}

}  // namespace palpate::franka_bridge
