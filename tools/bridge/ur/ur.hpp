#pragma once

#include <array>
#include <functional>
#include <optional>

#include "rtde_client.hpp"
#include "script.hpp"
#include "tools/bridge/common/protocol.hpp"

namespace palpate::ur_bridge {

using bridge::Joints;

/// An arm of Universal Robots: state and velocities by RTDE, and a program on its controller that
/// moves it by speedj. That program is sent when motion is wanted, stops by itself when commands
/// stop, and is sent again only after palpated has rested.
class Ur final : public bridge::Protocol, public bridge::WrenchInput {
 public:
  static constexpr int kJoints = 6;

  enum class Torque { kNone, kConstants, kReported };
  /// actual_TCP_force, which is without the controller's payload.
  struct ControllerWrench {
    double polarity = -1;  // 1: of the sensor on the hand; -1: of the surroundings on the hand
    double payload = 0;    // kg that the controller has to subtract
  };
  struct Options {
    double rate = 500;    // 1/s, of states
    double stale = 0.05;  // s of delay, more than the shortest lately, at which a state is rejected
    Torque torque = Torque::kNone;
    std::array<double, kJoints> torque_constants{};  // N m/A, of kConstants
    std::optional<ControllerWrench> wrench;
    std::string script;  // text of follow_velocities.script
    ScriptNumbers numbers;
    std::function<std::int64_t()> now_ns;  // CLOCK_MONOTONIC
  };

  /// Throws std::invalid_argument for a script that cannot be filled in.
  Ur(std::unique_ptr<bridge::Stream> rtde, std::unique_ptr<bridge::Stream> scripts,
     Options options);

  void receive() override;
  bool take(bridge::Reading& reading) override;
  std::string complaint() override;
  bool foreign_command() override;
  void begin(const Joints& /*q*/) override { may_start_ = true; }
  void advance(const Joints& /*dq*/, double /*dt*/) override {}
  void send(const Joints& dq, std::int64_t utime) override;
  bool follows(const Joints& /*q*/) const override { return true; }
  bool is_stopped_by_command() const override { return true; }

  /// Of the controller, in its flange's axes about its flange, which is S.
  bool take(math::Wrench& wrench_S) override;

  std::int64_t late() const { return late_; }          // states
  std::int64_t programs() const { return programs_; }  // sent
  bool is_program_running() const { return program_ == Program::kRunning; }

 private:
  enum class Program { kNone, kStarting, kRunning };
  /// What the controller says about programs.
  struct ProgramState {
    std::uint32_t runtime = 0;
    std::int32_t echo = 0, run = 0;  // of the output registers
  };

  static std::vector<Variable> outputs(const Options& options);
  static std::vector<Variable> inputs(const Options& options);
  bool is_late(double timestamp, std::int64_t now_ns);
  void read_wrench(PackageReader& reader);
  void follow_program(const ProgramState& state, bool is_halted, std::int64_t now_ns);
  void end_program(const char* why, std::int64_t now_ns);
  void start_program(std::int64_t now_ns);

  Options options_;
  RtdeClient rtde_;
  ScriptSender sender_;
  Program program_ = Program::kNone;
  const char* ended_ = nullptr;  // why the program has ended, if it has lately
  const char* paused_ = nullptr;
  bool may_start_ = false;
  bool foreign_ = false;
  std::int64_t program_ns_ = 0;  // when program_ began
  std::int64_t echo_ns_ = 0;     // when the counter has last come back
  std::int32_t echo_ = 0, counter_ = 0;
  std::optional<std::int64_t> shortest_ns_;  // delay, with an unknown constant
  std::int64_t state_ns_ = 0;
  bool is_delayed_ = false;
  math::Wrench wrench_S_;
  bool has_wrench_ = false, has_other_payload_ = false;
  std::string remark_;
  std::int64_t late_ = 0, programs_ = 0;
};

}  // namespace palpate::ur_bridge
