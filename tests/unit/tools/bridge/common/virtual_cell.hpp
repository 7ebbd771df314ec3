#pragma once

#include <functional>
#include <memory>
#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <string>
#include <vector>

#include "tools/bridge/common/bridged_arm.hpp"
#include "tools/driver/driver.hpp"

namespace palpate::bridge {

/// A bridge between a mock of an arm's driver, which derived classes add, and a stand-in for
/// palpated, in virtual time.
class VirtualCell {
 public:
  explicit VirtualCell(int joints)
      : states_(std::make_unique<bus::TypedSubscription<robot_state_t>>(*peer, "ROBOT_STATE", 64)) {
    command.joint_count = joints;
    command.session = 1;
  }
  virtual ~VirtualCell() = default;

  /// Runs for `ms`; palpated publishes `command` every 5 ms unless it is dead.
  void run(int ms) {
    for (int i = 0; i < ms; ++i) {
      now_ns += 1'000'000;
      bus::set_time(*hub_, now_ns);
      step_arm();
      if (now_ns / 1'000'000 % 5 == 0 && !is_palpated_dead) {
        ++command.seq;
        commands_.publish(command);
      }
      if (each) each();
      driver->cycle(now_ns, now_ns / 1000);
      std::int64_t arrival_ns = 0;
      while (states_->take(state, arrival_ns)) ++states;
    }
  }
  void rest() { command.valid = 0; }
  void move(const driver::Joints& dq) {
    command.valid = 1;
    Eigen::Map<Eigen::VectorXd>(command.dq, command.joint_count) = dq;
  }
  void move(double speed) { move(driver::Joints::Constant(command.joint_count, speed)); }
  bool has_said(const std::string& text) const {
    for (const std::string& line : said)
      if (line.find(text) != std::string::npos) return true;
    return false;
  }

 protected:
  /// The mock, for 1 ms.
  virtual void step_arm() = 0;
  void bridge(const kinematics::SerialChain& chain, std::unique_ptr<Protocol> protocol,
              WrenchInput* wrenches) {
    BridgedArm::Options options;
    options.now_ns = [this] { return now_ns; };
    options.wall_clock = [this] { return now_ns / 1000; };
    options.say = [this](const std::string& text) { said.push_back(text); };
    arm = std::make_unique<BridgedArm>(chain.joint_count(), std::move(protocol), options, wrenches);
    driver = std::make_unique<driver::Driver>(*ours_, chain, driver::JointGuard::Options(),
                                              bus::Access(), *arm);
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> ours_ = bus::make_memory_bus(hub_);

 public:
  std::unique_ptr<bus::MessageBus> peer = bus::make_memory_bus(hub_);
  std::int64_t now_ns = 1'000'000'000;
  std::unique_ptr<BridgedArm> arm;
  std::unique_ptr<driver::Driver> driver;
  joint_velocity_command_t command{};
  bool is_palpated_dead = false;
  std::function<void()> each;  // in every ms
  robot_state_t state{};       // the last published
  int states = 0;              // number of them
  std::vector<std::string> said;

 private:
  std::unique_ptr<bus::TypedSubscription<robot_state_t>> states_;
  bus::TypedPublisher<joint_velocity_command_t> commands_{*peer, "JOINT_VELOCITY_COMMAND"};
};

}  // namespace palpate::bridge
