#pragma once

#include <unistd.h>
#include <cmath>
#include <limits>

#include "rt/registry/arm_model.hpp"
#include "tests/unit/tools/bridge/common/virtual_cell.hpp"
#include "tools/bridge/ros2/conversions.hpp"
#include "tools/bridge/ros2/joint_state_arm.hpp"

namespace palpate::ros2_bridge {

/// On the loopback interface, in a domain of this process. Messages between participants of one
/// process arrive at once.
inline const Participant& participant(int index) {
  const static Participant::Options options{1 + static_cast<int>(getpid() % 200), "lo", {}};
  const static Participant participants[] = {Participant(options), Participant(options)};
  return participants[index];
}
inline const Participant& ours() { return participant(0); }
inline const Participant& theirs() { return participant(1); }

/// An arm as a node of ROS 2 that follows the last command for ever.
class MockNode {
 public:
  MockNode(const kinematics::SerialChain& chain, const driver::Joints& q)
      : q_(q), dq_(driver::Joints::Zero(q.size())) {
    for (int i = 0; i < chain.joint_count(); ++i) names_.push_back(chain.joint(i).name);
  }

  void step(std::int64_t now_ns) {
    while (const Float64MultiArray* const command = commands_.next()) {
      ++received;
      ASSERT_EQ(command->data._length, names_.size());
      dq_ = Eigen::Map<const Eigen::VectorXd>(command->data._buffer, command->data._length);
    }
    q_ += 1e-3 * dq_;
    if (!is_silent) publish(now_ns);
  }
  /// Of another controller, at rest.
  void command_otherwise() {
    Float64MultiArray message{};
    std::vector<double> zero(names_.size(), 0);
    refer(message.data, zero);
    others_.write(message);
  }
  double speed() const { return dq_.cwiseAbs().maxCoeff(); }
  const driver::Joints& q() const { return q_; }

  bool is_silent = false, has_nan = false, is_short = false, lacks_joint = false;
  std::int64_t age_ns = 0;  // of stamps
  int received = 0;

 private:
  void publish(std::int64_t now_ns) {
    std::vector<char*> names;
    for (std::string& name : names_) names.push_back(name.data());
    if (lacks_joint) names[2] = names[1];
    std::vector<double> q(q_.data(), q_.data() + q_.size()),
        dq(dq_.data(), dq_.data() + dq_.size());
    if (has_nan) dq[1] = std::numeric_limits<double>::quiet_NaN();
    if (is_short) q.pop_back();
    JointState message{};
    std::string frame;
    message.header = {stamp_of((now_ns - age_ns) / 1000), frame.data()};
    refer(message.name, names);
    refer(message.position, q);
    refer(message.velocity, dq);
    states_.write(message);
  }

  std::vector<std::string> names_;
  driver::Joints q_, dq_;
  Writer<JointState> states_{theirs(), {"states", Quality::kStream, 1}};
  Reader<Float64MultiArray> commands_{theirs(), {"commands", Quality::kReliable, 4, true}};
  Writer<Float64MultiArray> others_{theirs(), {"commands", Quality::kReliable, 1}};
};

/// The bridge between such an arm and a stand-in for palpated, in virtual time.
class Cell final : public bridge::VirtualCell {
 public:
  explicit Cell(const driver::Joints& q = bent(), Clock clock = {})
      : VirtualCell(chain().joint_count()), node(chain(), q) {
    JointStateArm::Options options;
    options.states = "states";
    options.commands = "commands";
    options.clock = clock;
    options.now_ns = [this] { return now_ns; };
    options.wall_clock = [this] { return now_ns / 1000; };
    auto owned = std::make_unique<JointStateArm>(ours(), chain(), options);
    protocol = owned.get();
    bridge(chain(), std::move(owned), nullptr);
  }

  static const kinematics::SerialChain& chain() {
    static const kinematics::SerialChain arm =
        registry::read_urdf(std::string(PALPATE_SOURCE_DIR) + "/sim/robot/lwr_hand.urdf", "flange");
    return arm;
  }
  static driver::Joints bent() {
    driver::Joints q = driver::Joints::Constant(chain().joint_count(), 0.5);
    q[3] = -1.2;
    return q;
  }

  MockNode node;
  JointStateArm* protocol;

 private:
  void step_arm() override { node.step(now_ns); }
};

}  // namespace palpate::ros2_bridge
