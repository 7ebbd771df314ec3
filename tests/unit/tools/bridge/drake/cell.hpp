#pragma once

#include "rt/registry/arm_model.hpp"
#include "tests/unit/tools/bridge/common/virtual_cell.hpp"
#include "tests/unit/tools/bridge/drake/mock_driver.hpp"
#include "tools/bridge/drake/iiwa.hpp"
#include "tools/bridge/drake/panda.hpp"

namespace palpate::drake_bridge {

/// The bridge between a mock of Drake's driver and a stand-in for palpated, in virtual time.
class Cell final : public bridge::VirtualCell {
 public:
  static constexpr int kJoints = 7;

  explicit Cell(MockDriver::Kind kind, const driver::Joints& q = bent(),
                bool external_torque = false)
      : VirtualCell(kJoints), drake(kind, *peer, q), kind_(kind) {
    std::unique_ptr<Protocol> protocol;
    if (kind == MockDriver::Kind::kIiwa)
      protocol = std::make_unique<Iiwa>(*ours_, chain(), "IIWA_STATUS", "IIWA_COMMAND", 0.02,
                                        external_torque);
    else
      protocol = std::make_unique<Panda>(*ours_, kJoints, "PANDA_STATUS", "PANDA_COMMAND",
                                         external_torque);
    bridge(chain(), std::move(protocol), &wrist_);
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

  MockDriver drake;

 private:
  void step_arm() override { drake.step(now_ns); }

  MockDriver::Kind kind_;
  ForceTorqueInput wrist_{*ours_, "WRIST"};
};

}  // namespace palpate::drake_bridge
