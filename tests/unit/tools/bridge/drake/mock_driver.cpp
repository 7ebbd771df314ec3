#include "tests/unit/tools/bridge/drake/mock_driver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::drake_bridge {
namespace {

std::vector<double> numbers(const driver::Joints& joints) {
  return {joints.data(), joints.data() + joints.size()};
}

driver::Joints joints(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

template <class Command>
Command sized(int joints) {
  Command command{};
  if constexpr (std::is_same_v<Command, ::drake::lcmt_iiwa_command>) {
    command.num_joints = joints;
    command.joint_position.resize(joints);
  } else if constexpr (std::is_same_v<Command, ::drake::lcmt_panda_command>) {
    command.num_joint_velocity = joints;
    command.joint_velocity.resize(joints);
  } else {
    command.num_joints = joints;
    for (auto* one : {&command.joint_position, &command.joint_velocity, &command.joint_torque})
      one->resize(joints);
  }
  return command;
}

template <class Command>
bus::Subscription* commands_on(bus::MessageBus& bus, const char* channel, int joints) {
  return &bus.subscribe(channel, sized<Command>(joints).getEncodedSize(), Command::getHash(), 64);
}

}  // namespace

MockDriver::MockDriver(Kind kind, bus::MessageBus& bus, const driver::Joints& q)
    : kind_(kind), bus_(bus), q_(q), target_(q) {
  const int n = static_cast<int>(q.size());
  commands_ = kind == Kind::kIiwa ? commands_on<::drake::lcmt_iiwa_command>(bus, "IIWA_COMMAND", n)
              : kind == Kind::kPanda
                  ? commands_on<::drake::lcmt_panda_command>(bus, "PANDA_COMMAND", n)
                  : commands_on<::drake::lcmt_panda_command_v1>(bus, "PANDA_COMMAND", n);
  dq_.setZero(n);
  velocity_.setZero(n);
}

void MockDriver::restart() {
  std::int64_t arrival_ns = 0;
  while (commands_->take(arrival_ns) != nullptr) {
  }
  first_ns_.reset();
  command_.reset();
  synchronised_ns_ = -1;
  target_ = q_;
  velocity_.setZero();
}

void MockDriver::receive(std::int64_t now_ns) {
  std::int64_t arrival_ns = 0;
  while (const void* data = commands_->take(arrival_ns)) {
    if (is_absent) continue;
    ++received_;
    if (kind_ == Kind::kIiwa && (!first_ns_ || now_ns - *first_ns_ < kGuard)) gave_up_ = true;
    command_ = now_ns;
    const auto read = [&](auto command) {
      if (command.decode(data, 0, commands_->encoded_size()) < 0)
        throw std::logic_error("not a command");
      return command;
    };
    if (kind_ == Kind::kIiwa)
      target_ = joints(read(::drake::lcmt_iiwa_command()).joint_position);
    else if (kind_ == Kind::kPanda)
      velocity_ = joints(read(::drake::lcmt_panda_command()).joint_velocity);
    else
      velocity_ = joints(read(::drake::lcmt_panda_command_v1()).joint_velocity);
  }
}

void MockDriver::move(double dt, std::int64_t now_ns) {
  if (is_stopped) {
    dq_.setZero();
    return;
  }
  const double share = std::min(1.0, dt / kLag);
  if (kind_ == Kind::kIiwa) {
    dq_ = share / dt * (target_ - q_);
  } else {
    if (!command_ || now_ns - *command_ > kExpiry) velocity_.setZero();
    dq_ += share * (velocity_ - dq_);
  }
  q_ += dt * dq_;
}

template <class Status>
void MockDriver::enqueue(const Status& status, std::int64_t now_ns) {
  std::vector<std::uint8_t> data(status.getEncodedSize());
  status.encode(data.data(), 0, static_cast<int>(data.size()));
  if (has_other_type) data[7] ^= 0xff;
  waiting_.emplace_back(now_ns + delay_ns, std::move(data));
}

template <class Status>
Status MockDriver::panda_status(std::int64_t now_ns) const {
  Status status{};
  status.utime = now_ns / 1000;
  status.num_joints = static_cast<int>(q_.size());
  for (auto* one : {&status.joint_position_desired, &status.joint_velocity_desired,
                    &status.joint_acceleration_desired, &status.joint_torque_desired,
                    &status.joint_torque_external, &status.joint_torque})
    one->resize(q_.size());
  status.joint_position = numbers(q_);
  status.joint_velocity = numbers(dq_);
  status.joint_torque[1] = 20;
  status.joint_torque_external[1] = 3;
  status.robot_mode = static_cast<std::int8_t>(is_stopped ? 5 : robot_mode);
  if (has_nan) status.joint_position[2] = std::numeric_limits<double>::quiet_NaN();
  return status;
}

void MockDriver::publish(std::int64_t now_ns) {
  if (!first_ns_) first_ns_ = now_ns;
  if (kind_ == Kind::kPanda) {
    auto status = panda_status<::drake::lcmt_panda_status>(now_ns);
    status.control_mode = static_cast<std::int8_t>(control_mode);
    enqueue(status, now_ns);
  } else if (kind_ == Kind::kFormerPanda) {
    auto status = panda_status<::drake::lcmt_panda_status_v1>(now_ns);
    status.velocity_control_enabled = (control_mode & 2) != 0;
    status.position_control_enabled = (control_mode & 1) != 0;
    enqueue(status, now_ns);
  } else {
    ::drake::lcmt_iiwa_status status{};
    if (synchronised_ns_ < 0) synchronised_ns_ = now_ns + 50'000'000;
    status.utime = now_ns < synchronised_ns_ ? -1 : now_ns / 1000;
    status.num_joints = static_cast<int>(q_.size());
    for (auto* one : {&status.joint_position_ipo, &status.joint_torque_commanded,
                      &status.joint_torque_external, &status.joint_torque_measured})
      one->resize(q_.size());
    status.joint_position_measured = numbers(q_);
    status.joint_velocity_estimated = numbers(dq_);
    status.joint_position_commanded = numbers(target_);
    status.joint_position_ipo.assign(q_.size(), std::numeric_limits<double>::quiet_NaN());
    status.joint_torque_measured[1] = 20;
    status.joint_torque_external[1] = 3;
    if (has_nan) status.joint_position_measured[2] = std::numeric_limits<double>::quiet_NaN();
    enqueue(status, now_ns);
  }
}

void MockDriver::step(std::int64_t now_ns) {
  const std::int64_t ms = kind_ == Kind::kIiwa ? 5 : 1;
  receive(now_ns);
  if (now_ns / 1'000'000 % ms == 0) {
    move(1e-3 * static_cast<double>(ms), now_ns);
    if (!is_absent && !is_mute) publish(now_ns);
  }
  while (!waiting_.empty() && waiting_.front().first <= now_ns) {
    const std::vector<std::uint8_t>& data = waiting_.front().second;
    bus_.publish(kind_ == Kind::kIiwa ? "IIWA_STATUS" : "PANDA_STATUS", data.data(),
                 static_cast<int>(data.size()));
    waiting_.pop_front();
  }
}

}  // namespace palpate::drake_bridge
