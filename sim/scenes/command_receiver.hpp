#pragma once

#include <cstdint>
#include <palpate/hand_command_t.hpp>
#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "sim/robot/robot.hpp"
#include "sim/scenes/hand_control.hpp"

namespace palpate::scenes {

/// Hands the daemon's commands to arm and hand as a robot's driver does: the newest counts, one
/// that is not valid stops the arm, one that is broken is rejected and counted. With a key, so is
/// one that was not sealed with it, or that came before: a stray program cannot steer the arm.
class CommandReceiver {
 public:
  /// Of arm 0 or 1. Before the bus starts.
  explicit CommandReceiver(bus::MessageBus& control, int arm = 0,
                           const std::optional<bus::Key>& key = {});

  /// From now on rejects what was sealed before `start_us`, wall clock.
  void begin(std::int64_t start_us);

  /// What moves the arm.
  void apply(robot::Robot& robot);
  void apply(HandControl& hand);

  std::int64_t accepted() const { return accepted_; }
  std::int64_t rejected() const { return rejected_; }
  /// Of those rejected, the ones without a valid code or with an old counter.
  std::int64_t refused() const;
  /// That never came: gaps in the sequences, and what a full queue dropped.
  std::int64_t lost() const;

 private:
  void apply(const twist_command_t& message, robot::Robot& robot);
  void apply(const joint_velocity_command_t& message, robot::Robot& robot);

  int arm_;
  bus::TypedSubscription<twist_command_t> twists_;
  bus::TypedSubscription<joint_velocity_command_t> joints_;
  bus::TypedSubscription<hand_command_t> hands_;
  bus::Admission twist_admission_, joint_admission_, hand_admission_;
  bus::SequenceTracker twist_order_, joint_order_, hand_order_;
  std::int64_t accepted_ = 0;
  std::int64_t rejected_ = 0;
};

}  // namespace palpate::scenes
