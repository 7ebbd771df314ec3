#pragma once

#include <memory>
#include <palpate/joint_velocity_command_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <random>
#include <string>
#include <vector>

#include "rt/registry/arm_model.hpp"
#include "tests/unit/tools/bridge/drake/mock_driver.hpp"
#include "tools/bridge/drake/drake_arm.hpp"
#include "tools/bridge/drake/iiwa.hpp"
#include "tools/bridge/drake/panda.hpp"
#include "tools/driver/driver.hpp"

namespace palpate::drake_bridge {

/// The bridge between a mock of Drake's driver and a stand-in for palpated, in virtual time.
class Cell {
 public:
  static constexpr int kJoints = 7;

  explicit Cell(MockDriver::Kind kind, const driver::Joints& q = bent())
      : kind_(kind),
        drake(kind, *peer, q),
        states_(std::make_unique<bus::TypedSubscription<robot_state_t>>(*peer, "ROBOT_STATE", 64)) {
    DrakeArm::Options options;
    options.wrench = "WRIST";
    options.now_ns = [this] { return now_ns; };
    options.wall_clock = [this] { return now_ns / 1000; };
    options.say = [this](const std::string& text) { said.push_back(text); };
    std::unique_ptr<Protocol> protocol;
    if (kind == MockDriver::Kind::kIiwa)
      protocol = std::make_unique<Iiwa>(*ours_, chain(), "IIWA_STATUS", "IIWA_COMMAND", 0.02);
    else
      protocol = std::make_unique<Panda>(*ours_, kJoints, "PANDA_STATUS", "PANDA_COMMAND");
    arm = std::make_unique<DrakeArm>(*ours_, kJoints, std::move(protocol), options);
    driver = std::make_unique<driver::Driver>(*ours_, chain(), driver::JointGuard::Options(),
                                              bus::Access(), *arm);
    command.joint_count = kJoints;
    command.session = 1;
  }

  static const kinematics::SerialChain& chain() {
    static const kinematics::SerialChain arm =
        registry::read_urdf(std::string(PALPATE_SOURCE_DIR) + "/sim/robot/lwr_hand.urdf", "flange");
    return arm;
  }
  static driver::Joints bent() {
    driver::Joints q = driver::Joints::Constant(kJoints, 0.5);
    q[3] = -1.2;
    return q;
  }

  /// Runs for `ms`; palpated publishes `command` every 5 ms unless it is dead.
  void run(int ms) {
    for (int i = 0; i < ms; ++i) {
      now_ns += 1'000'000;
      bus::set_time(*hub_, now_ns);
      drake.step(now_ns);
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
    Eigen::Map<Eigen::VectorXd>(command.dq, kJoints) = dq;
  }
  void move(double speed) { move(driver::Joints::Constant(kJoints, speed)); }
  bool has_said(const std::string& text) const {
    for (const std::string& line : said)
      if (line.find(text) != std::string::npos) return true;
    return false;
  }
  /// A command of another program, which holds the arm at its pose.
  void publish_foreign_command() {
    const driver::Joints& at = drake.q();
    if (kind_ == MockDriver::Kind::kIiwa) {
      ::drake::lcmt_iiwa_command foreign{};
      foreign.utime = now_ns / 1000 - 7;
      foreign.num_joints = kJoints;
      foreign.joint_position.assign(at.data(), at.data() + kJoints);
      bus::TypedPublisher<::drake::lcmt_iiwa_command>(*peer, "IIWA_COMMAND").publish(foreign);
    } else {
      ::drake::lcmt_panda_command foreign{};
      foreign.utime = now_ns / 1000 - 7;
      foreign.num_joint_velocity = kJoints;
      foreign.joint_velocity.resize(kJoints);
      foreign.control_mode_expected = 2;
      bus::TypedPublisher<::drake::lcmt_panda_command>(*peer, "PANDA_COMMAND").publish(foreign);
    }
  }

 private:
  MockDriver::Kind kind_;
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> ours_ = bus::make_memory_bus(hub_);

 public:
  std::unique_ptr<bus::MessageBus> peer = bus::make_memory_bus(hub_);
  std::int64_t now_ns = 1'000'000'000;
  MockDriver drake;
  std::unique_ptr<DrakeArm> arm;
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

}  // namespace palpate::drake_bridge
