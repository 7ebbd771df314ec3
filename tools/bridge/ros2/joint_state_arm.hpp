#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/kinematics/serial_chain.hpp"
#include "intake.hpp"
#include "participant.hpp"
#include "tools/bridge/common/protocol.hpp"

namespace palpate::ros2_bridge {

using bridge::Joints;

/// Finds the joints of an arm in messages that may hold those of other devices too, in any order.
class JointSelection {
 public:
  explicit JointSelection(std::vector<std::string> names);

  enum class Result { kRead, kOthers, kRefused };
  /// Positions, velocities and, where there are any, efforts. kOthers: has none of the joints;
  /// kRefused, with the reason: has some, without position or velocity of each.
  Result read(const JointState& message, bridge::Reading& reading, const char*& reason);

 private:
  bool find(const JointState& message);

  std::vector<std::string> names_;
  std::vector<std::uint32_t> places_;
  std::size_t found_ = 0;
};

/// An arm by its joint states, commanded by joint velocities (std_msgs/Float64MultiArray, in the
/// order from the base) or by the twist of E in W (geometry_msgs/TwistStamped).
class JointStateArm final : public bridge::Protocol {
 public:
  enum class Commands { kVelocities, kTwist };
  struct Options {
    std::string states = "joint_states";  // topics
    std::string commands;
    Commands kind = Commands::kVelocities;
    std::vector<std::string> joints;  // names in the joint states; empty: those of the chain
    std::string frame = "base_link";  // name of W in the twist's header
    Clock clock;
    std::function<std::int64_t()> now_ns, wall_clock;  // as of BridgedArm
  };

  /// The participant outlives this object.
  JointStateArm(const Participant& participant, const kinematics::SerialChain& chain,
                const Options& options);
  /// Sends zero, if anything has been sent: controllers of ROS 2 may follow the last command for
  /// ever.
  ~JointStateArm() override;

  void receive() override {}
  bool take(bridge::Reading& reading) override;
  std::string complaint() override { return intake_.complaint(); }
  bool foreign_command() override;
  void begin(const Joints& /*q*/) override {}
  void advance(const Joints& /*dq*/, double /*dt*/) override {}
  void send(const Joints& dq, std::int64_t utime) override;
  bool follows(const Joints& /*q*/) const override { return true; }
  bool is_stopped_by_command() const override { return true; }

  const Intake& intake() const { return intake_; }

 private:
  /// Publishes commands of one kind, and hears those of others.
  template <class Message>
  struct Topic {
    Topic(const Participant& participant, const std::string& name)
        : writer(participant, {name, Quality::kReliable}),
          others(participant, {name, Quality::kStream, 1, true}) {}
    bool any_foreign();
    Writer<Message> writer;
    Reader<Message> others;
  };

  kinematics::SerialChain chain_;
  kinematics::SerialChain::State pose_;
  Options options_;
  JointSelection selection_;
  Reader<JointState> states_;
  Intake intake_;
  std::unique_ptr<Topic<Float64MultiArray>> velocities_;
  std::unique_ptr<Topic<TwistStamped>> twists_;
  Joints q_;
  std::vector<double> numbers_;
  bool has_sent_ = false;
};

}  // namespace palpate::ros2_bridge
