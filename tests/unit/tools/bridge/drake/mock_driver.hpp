#pragma once

#include <cstdint>
#include <deque>
#include <drake/lcmt_iiwa_command.hpp>
#include <drake/lcmt_iiwa_status.hpp>
#include <drake/lcmt_panda_command.hpp>
#include <drake/lcmt_panda_command_v1.hpp>
#include <drake/lcmt_panda_status.hpp>
#include <drake/lcmt_panda_status_v1.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "tools/driver/arm.hpp"

namespace palpate::drake_bridge {

/// What Drake's drivers do with an arm, in virtual time: the iiwa's follows positions and gives up
/// at a command within 0.25 s of its first status; the panda's follows velocities no older than
/// 0.1 s. The members are faults.
class MockDriver {
 public:
  enum class Kind { kIiwa, kPanda, kFormerPanda };
  static constexpr double kLag = 0.005;                 // s, of the arm
  static constexpr std::int64_t kGuard = 250'000'000;   // ns
  static constexpr std::int64_t kExpiry = 100'000'000;  // ns

  MockDriver(Kind kind, bus::MessageBus& bus, const driver::Joints& q);

  /// Once per ms.
  void step(std::int64_t now_ns);
  /// As by a new process, which has not received earlier commands, and whose clock is not yet that
  /// of the arm.
  void restart();

  const driver::Joints& q() const { return q_; }
  double speed() const { return dq_.lpNorm<Eigen::Infinity>(); }  // rad/s, of the fastest joint
  bool gave_up() const { return gave_up_; }
  std::int64_t received() const { return received_; }  // commands

  bool is_absent = false;  // neither receives nor publishes, and the arm does what it did
  bool is_mute = false;    // publishes nothing
  bool has_nan = false;    // in its positions
  bool has_other_type = false;
  std::int64_t delay_ns = 0;  // of its statuses
  bool is_stopped = false;    // by a button: the panda reports it, the iiwa does not move
  int robot_mode = 2, control_mode = 2;

 private:
  void receive(std::int64_t now_ns);
  void move(double dt, std::int64_t now_ns);
  void publish(std::int64_t now_ns);
  template <class Status>
  void enqueue(const Status& status, std::int64_t now_ns);
  template <class Status>
  Status panda_status(std::int64_t now_ns) const;

  Kind kind_;
  bus::MessageBus& bus_;
  bus::Subscription* commands_;
  driver::Joints q_, dq_, target_, velocity_;
  std::optional<std::int64_t> first_ns_, command_;
  std::int64_t synchronised_ns_ = 0;
  bool gave_up_ = false;
  std::int64_t received_ = 0;
  std::deque<std::pair<std::int64_t, std::vector<std::uint8_t>>> waiting_;
};

}  // namespace palpate::drake_bridge
