#pragma once

#include <fstream>
#include <sstream>

#include "rt/registry/arm_model.hpp"
#include "tests/unit/tools/bridge/common/virtual_cell.hpp"
#include "tests/unit/tools/bridge/ur/mock_controller.hpp"
#include "tools/bridge/ur/ur.hpp"

namespace palpate::ur_bridge {

inline std::string text_of(const std::string& path) {
  std::ifstream file(std::string(PALPATE_SOURCE_DIR) + "/" + path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The bridge between a mock of the controller and a stand-in for palpated, in virtual time.
class Cell final : public bridge::VirtualCell {
 public:
  explicit Cell(int period_ms = 2, const driver::Joints& q = bent(),
                const std::function<void(Ur::Options&)>& change = {})
      : VirtualCell(Ur::kJoints), controller(q, period_ms) {
    Ur::Options options;
    options.rate = 1000.0 / period_ms;
    options.script = text_of("tools/bridge/ur/follow_velocities.script");
    options.now_ns = [this] { return now_ns; };
    if (change) change(options);
    auto protocol =
        std::make_unique<Ur>(controller.rtde_stream(), controller.script_stream(), options);
    ur = protocol.get();
    bridge(chain(), std::move(protocol), options.wrench ? ur : nullptr);
  }

  static const kinematics::SerialChain& chain() {
    static const kinematics::SerialChain arm = registry::read_urdf(
        std::string(PALPATE_SOURCE_DIR) + "/tools/bridge/ur/examples/ur5e.urdf", "flange");
    return arm;
  }
  static driver::Joints bent() {
    driver::Joints q(Ur::kJoints);
    q << 0.3, -1.2, 1.1, -1.4, -1.5, 0.2;
    return q;
  }

  /// palpated waits, then moves the arm: all joints at `speed`, rad/s.
  void start(double speed) {
    rest();
    run(300);
    move(speed);
    run(250);
  }

  MockController controller;
  Ur* ur = nullptr;

 private:
  void step_arm() override { controller.step(now_ns); }
};

}  // namespace palpate::ur_bridge
