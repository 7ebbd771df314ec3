#pragma once

#include <functional>

#include "rt/registry/arm_model.hpp"
#include "tests/unit/tools/bridge/common/virtual_cell.hpp"
#include "tests/unit/tools/bridge/franka/mock_arm.hpp"
#include "tools/bridge/franka/franka.hpp"

namespace palpate::franka_bridge {

/// The bridge between a mock of the arm and a stand-in for palpated, in virtual time.
class Cell final : public bridge::VirtualCell {
 public:
  explicit Cell(const driver::Joints& q = bent(),
                const std::function<void(Franka::Options&)>& change = {})
      : VirtualCell(kJoints), mock(q) {
    Franka::Options options;
    options.now_ns = [this] { return now_ns; };
    if (change) change(options);
    auto protocol = std::make_unique<Franka>(mock.stream(), mock.datagrams(), options);
    franka = protocol.get();
    bridge(chain(), std::move(protocol), options.wrench ? franka : nullptr);
  }

  static const kinematics::SerialChain& chain() {
    static const kinematics::SerialChain arm = registry::read_urdf(
        std::string(PALPATE_SOURCE_DIR) + "/tools/bridge/franka/examples/fr3.urdf", "flange");
    return arm;
  }
  static driver::Joints bent() {
    driver::Joints q(kJoints);
    q << 0, -0.4, 0, -2.2, 0, 1.9, 0.7;
    return q;
  }

  /// palpated waits, then moves the arm: all joints at `speed`, rad/s.
  void start(double speed) {
    rest();
    run(300);
    move(speed);
    run(120);
  }

  MockArm mock;
  Franka* franka = nullptr;

 private:
  void step_arm() override { mock.step(now_ns); }
};

}  // namespace palpate::franka_bridge
