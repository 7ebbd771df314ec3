#pragma once

#include <drake/lcmt_iiwa_command.hpp>
#include <drake/lcmt_iiwa_status.hpp>

#include "messages.hpp"

namespace palpate::drake_bridge {

/// Drake's driver of an iiwa, and its simulation: position commands, integrated from where the arm
/// stands.
class Iiwa final : public Protocol {
 public:
  /// `follow`: rad, error of a joint at rest above which the arm does not follow;
  /// `external_torque`: report that instead of the measured one.
  Iiwa(bus::MessageBus& bus, const kinematics::SerialChain& chain, const std::string& status,
       const std::string& command, double follow, bool external_torque);

  void receive() override { bus_.receive(0); }
  bool take(Reading& reading) override;
  std::string complaint() override { return refusals_.next(); }
  bool foreign_command() override { return commands_.any_foreign(); }
  void begin(const Joints& q) override;
  void advance(const Joints& dq, double dt) override;
  void send(const Joints& dq, std::int64_t utime) override;
  bool follows(const Joints& q) const override;
  bool is_stopped_by_command() const override { return false; }

 private:
  bus::MessageBus& bus_;
  StatusInput<::drake::lcmt_iiwa_status> statuses_;
  Refusals refusals_;
  CommandOutput<::drake::lcmt_iiwa_command> commands_;
  double follow_;
  bool external_torque_;
  Joints lower_, upper_;  // rad
  Joints target_;         // rad
  Joints speed_;          // rad/s, of the last moments
};

}  // namespace palpate::drake_bridge
