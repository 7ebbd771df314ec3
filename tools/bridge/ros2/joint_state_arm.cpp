#include "joint_state_arm.hpp"

#include "conversions.hpp"

namespace palpate::ros2_bridge {
namespace {

std::vector<std::string> names_of(const kinematics::SerialChain& chain) {
  std::vector<std::string> names;
  for (int i = 0; i < chain.joint_count(); ++i) names.push_back(chain.joint(i).name);
  return names;
}

}  // namespace

JointSelection::JointSelection(std::vector<std::string> names)
    : names_(std::move(names)), places_(names_.size(), 0) {}

/// Sets places_ and found_; true if all are found.
bool JointSelection::find(const JointState& message) {
  const auto is_at = [&](std::size_t joint, std::uint32_t place) {
    return place < message.name._length && names_[joint] == message.name._buffer[place];
  };
  found_ = 0;
  for (std::size_t joint = 0; joint < names_.size(); ++joint) {
    std::uint32_t& place = places_[joint];  // of the last message, usually still right
    if (!is_at(joint, place)) {
      place = 0;
      while (place < message.name._length && !is_at(joint, place)) ++place;
    }
    if (place < message.name._length) ++found_;
  }
  return found_ == names_.size();
}

JointSelection::Result JointSelection::read(const JointState& message, bridge::Reading& reading,
                                            const char*& reason) {
  if (!find(message)) {
    reason = "has only some of the arm's joints";
    return found_ == 0 ? Result::kOthers : Result::kRefused;
  }
  const std::uint32_t size = message.name._length;
  reason = "positions and velocities are not as many as names";
  if (message.position._length != size || message.velocity._length != size) return Result::kRefused;
  const bool has_effort = message.effort._length == size;
  if (!has_effort && message.effort._length != 0) return Result::kRefused;
  for (std::size_t joint = 0; joint < names_.size(); ++joint) {
    const auto row = static_cast<Eigen::Index>(joint);
    const std::uint32_t place = places_[joint];
    reading.q[row] = message.position._buffer[place];
    reading.dq[row] = message.velocity._buffer[place];
    reading.tau[row] = has_effort ? message.effort._buffer[place] : 0;
  }
  reason = "positions or velocities are not finite";
  return reading.q.allFinite() && reading.dq.allFinite() ? Result::kRead : Result::kRefused;
}

template <class Message>
bool JointStateArm::Topic<Message>::any_foreign() {
  bool any = false;
  while (others.next() != nullptr) any = true;
  return any;
}

JointStateArm::JointStateArm(const Participant& participant, const kinematics::SerialChain& chain,
                             const Options& options)
    : chain_(chain),
      options_(options),
      selection_(options.joints.empty() ? names_of(chain) : options.joints),
      states_(participant, {options.states, Quality::kStream, 16}),
      intake_(options.states, options.clock),
      q_(Joints::Zero(chain.joint_count())) {
  if (options.kind == Commands::kTwist)
    twists_ = std::make_unique<Topic<TwistStamped>>(participant, options.commands);
  else
    velocities_ = std::make_unique<Topic<Float64MultiArray>>(participant, options.commands);
}

bool JointStateArm::take(bridge::Reading& reading) {
  while (const JointState* const message = states_.next()) {
    const char* reason = "";
    const JointSelection::Result result = selection_.read(*message, reading, reason);
    if (result == JointSelection::Result::kRefused) intake_.refuse(reason);
    if (result != JointSelection::Result::kRead) continue;
    const auto utime = intake_.admit(message->header.stamp, options_.wall_clock());
    if (!utime) continue;
    reading.utime = options_.clock.is_sender ? *utime : 0;
    reading.arrival_ns = options_.now_ns();
    reading.halted = nullptr;
    q_ = reading.q;
    return true;
  }
  return false;
}

bool JointStateArm::foreign_command() {
  return twists_ ? twists_->any_foreign() : velocities_->any_foreign();
}

void JointStateArm::send(const Joints& dq, std::int64_t utime) {
  has_sent_ = true;
  if (velocities_) {
    numbers_.assign(dq.data(), dq.data() + dq.size());
    Float64MultiArray message{};
    refer(message.data, numbers_);
    velocities_->writer.write(message);
    return;
  }
  chain_.evaluate(q_, pose_);
  const math::Vector6d V = pose_.J_W_E * dq;
  TwistStamped message{};
  message.header = {stamp_of(utime), options_.frame.data()};
  message.twist = {{V[0], V[1], V[2]}, {V[3], V[4], V[5]}};
  twists_->writer.write(message);
}

JointStateArm::~JointStateArm() {
  if (!has_sent_) return;
  send(Joints::Zero(q_.size()), options_.wall_clock());
  if (velocities_)
    velocities_->writer.flush();
  else
    twists_->writer.flush();
}

}  // namespace palpate::ros2_bridge
