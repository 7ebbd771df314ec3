#pragma once

#include <drake/lcmt_panda_command.hpp>
#include <drake/lcmt_panda_command_v1.hpp>
#include <drake/lcmt_panda_status.hpp>
#include <drake/lcmt_panda_status_v1.hpp>

#include "messages.hpp"

namespace palpate::drake_bridge {

/// drake-franka-driver in velocity mode, and Drake's simulation of it, by the present messages or
/// by those until 2021: commands are of the type that belongs to the last status.
class Panda final : public Protocol {
 public:
  /// `external_torque`: report that instead of the measured one.
  Panda(bus::MessageBus& bus, int joints, const std::string& status, const std::string& command,
        bool external_torque);

  void receive() override { bus_.receive(0); }
  bool take(Reading& reading) override;
  std::string complaint() override { return refusals_.next(); }
  bool foreign_command() override;
  void begin(const Joints& q) override { q_ = q; }
  void advance(const Joints& /*dq*/, double /*dt*/) override {}
  void send(const Joints& dq, std::int64_t utime) override;
  bool follows(const Joints& /*q*/) const override { return true; }
  bool is_stopped_by_command() const override { return true; }

 private:
  bus::MessageBus& bus_;
  StatusInput<::drake::lcmt_panda_status> statuses_;
  StatusInput<::drake::lcmt_panda_status_v1> former_statuses_;
  Refusals refusals_;
  CommandOutput<::drake::lcmt_panda_command> commands_;
  CommandOutput<::drake::lcmt_panda_command_v1> former_commands_;
  bool external_torque_;
  bool is_former_ = false;
  Joints q_;  // rad, where motion began
};

}  // namespace palpate::drake_bridge
