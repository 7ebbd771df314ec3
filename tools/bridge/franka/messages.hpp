#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

// Messages of the Franka Control Interface (FCI), version 10: packed structures, little-endian as
// the machines that palpate runs on. Reference: libfranka 0.18 and later.

namespace palpate::franka_bridge {

inline constexpr int kJoints = 7;
inline constexpr std::uint16_t kFciVersion = 10;
inline constexpr int kStateSize = 1377;   // bytes of a state
inline constexpr int kCommandSize = 371;  // bytes of a command
inline constexpr int kHeaderSize = 12;    // bytes in front of a request or an answer
inline constexpr int kErrors = 41;

using Seven = std::array<double, kJoints>;

enum class Request : std::uint32_t {
  kConnect = 0,
  kMove = 1,
  kAutomaticErrorRecovery = 10,
};

inline constexpr std::uint8_t kMotionStarted = 1;  // status of a first answer to kMove

enum class RobotMode : std::uint8_t {
  kOther,
  kIdle,
  kMove,
  kGuiding,
  kReflex,
  kUserStopped,
  kAutomaticErrorRecovery
};

inline constexpr std::uint8_t kIdleGenerator = 0;           // of the motion: none runs
inline constexpr std::uint8_t kJointVelocityGenerator = 2;  // of the motion

/// The part of a state that palpate uses.
struct RobotState {
  std::uint64_t id = 0;                   // ms, counted by the arm: one more in each state
  Seven q{}, dq{};                        // rad, rad/s
  Seven dq_d{}, ddq_d{};                  // rad/s, rad/s^2: the command that the arm executes
  Seven tau_J{};                          // N m, measured, with gravity
  Seven tau_ext{};                        // N m, external
  std::array<double, 6> F_K{};            // N, N m: K_F_ext_hat_K, external wrench in and about K
  std::array<double, 16> X_FE{}, X_EK{};  // F_T_EE, EE_T_K: columns of 4 by 4
  double load = 0;                        // kg, that F_K is without: m_ee + m_load
  std::uint8_t generator = 0;             // kIdleGenerator, kJointVelocityGenerator, or another
  RobotMode mode = RobotMode::kOther;
  std::array<bool, kErrors> reflex_reason{};

  bool is_moving() const {
    return mode == RobotMode::kMove && generator == kJointVelocityGenerator;
  }
};

/// `data`: kStateSize bytes. Numbers may be non-finite.
void read_state(const std::uint8_t* data, RobotState& state);

/// `data`: kCommandSize bytes. Answers the state `id` with joint velocities dq_c, rad/s; `is_last`:
/// the motion is to end.
void write_command(std::uint64_t id, const Seven& dq, bool is_last, std::uint8_t* data);

/// Whole requests, with their header.
std::vector<std::uint8_t> connect_request(std::uint32_t number, std::uint16_t udp_port);
/// Begins a motion by joint velocities under the arm's joint impedance.
std::vector<std::uint8_t> move_request(std::uint32_t number);
std::vector<std::uint8_t> recovery_request(std::uint32_t number);

struct Header {
  std::uint32_t request = 0, number = 0;
  std::uint32_t size = 0;  // bytes of the whole message
};
/// `data`: kHeaderSize bytes.
Header read_header(const std::uint8_t* data);

/// Of a final answer to kMove.
std::string move_status_name(std::uint8_t status);
/// Names of the errors that are set, separated by commas.
std::string names_of(const std::array<bool, kErrors>& errors);
/// Why the arm does not obey; nullptr: it does.
const char* halt_of(RobotMode mode) noexcept;

}  // namespace palpate::franka_bridge
