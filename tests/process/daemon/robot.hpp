#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <random>
#include <thread>

#include "rt/bus/message_bus.hpp"

namespace palpate {

/// A robot that holds the bar of the example, with its sensors, in a separate thread and with its
/// own bus. It moves up and down slightly; if it accepts commands, it also follows TWIST_COMMAND
/// exactly, as long as commands arrive.
class Robot {
 public:
  explicit Robot(const std::string& control_url, bool obeys = false)
      : bus_(bus::make_lcm_bus(control_url)),
        command_(*bus_, "TWIST_COMMAND", 64),
        state_(*bus_, "ROBOT_STATE"),
        wrench_(*bus_, "FT_WRENCH"),
        inertial_(*bus_, "IMU"),
        obeys_(obeys) {
    // The flange pose that holds the grasp at its rest pose: frames of the example.
    X_WE_.translation() = Eigen::Vector3d(1.36 - 0.47 - 0.30, 0, 0.31);
    X_WE_.linear() = Eigen::Quaterniond(std::sqrt(0.5), 0, std::sqrt(0.5), 0).toRotationMatrix();
    bus_->start();
    thread_ = std::thread([this] { run(); });
  }
  ~Robot() {
    stop_ = true;
    thread_.join();
    bus_->stop();
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

 private:
  static constexpr double kPeriod = 1e-3;  // s
  static constexpr int kPatience = 50;     // ticks without a command until it stands still

  void run() {
    auto next = std::chrono::steady_clock::now();
    for (int tick = 0; !stop_; ++tick) {
      if (obeys_) follow();
      publish(tick);
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
    }
  }
  void follow() {
    twist_command_t command{};
    std::int64_t arrival_ns = 0;
    ++silence_;
    while (command_.take(command, arrival_ns)) {
      last_ = command;
      silence_ = 0;
    }
    if (silence_ > kPatience) return;
    const Eigen::Map<const Eigen::Vector3d> linear(last_.twist), angular(last_.twist + 3);
    if (!linear.allFinite() || !angular.allFinite()) return;
    X_WE_.translation() += kPeriod * linear;
    const double angle = kPeriod * angular.norm();
    if (angle > 0) X_WE_.linear() = Eigen::AngleAxisd(angle, angular.normalized()) * X_WE_.linear();
  }
  double noise() { return normal_(random_); }
  template <class Message>
  void stamp(Message& message, int tick) {
    message.utime = 1000 * tick;
    message.seq = tick;
    message.session = 5;
  }
  void publish(int tick) {
    // Load of the hand on the wrist, and its specific force.
    const Eigen::Vector3d up_E = X_WE_.linear().transpose() * Eigen::Vector3d(0, 0, 9.81);
    const Eigen::Vector3d force = 4.8 * up_E;
    const Eigen::Vector3d torque = Eigen::Vector3d(0.0015, -0.00065, 0.1137).cross(force);
    ft_wrench_t wrench{};
    stamp(wrench, tick);
    for (int i = 0; i < 3; ++i) {
      wrench.wrench[i] = force[i] + 0.02 * noise();
      wrench.wrench[3 + i] = torque[i] + 0.001 * noise();
    }
    wrench_.publish(wrench);
    if (tick % 2 == 0) {
      robot_state_t state{};
      stamp(state, tick);
      state.joint_count = 7;
      Eigen::Map<Eigen::Vector3d>(state.position) = X_WE_.translation();
      state.position[2] += 0.005 * std::sin(0.004 * tick);
      Eigen::Quaterniond q(X_WE_.linear());
      q.normalize();
      const double wxyz[] = {q.w(), q.x(), q.y(), q.z()};
      std::copy_n(wxyz, 4, state.quaternion);
      state_.publish(state);
    }
    if (tick % 3 == 0) {
      imu_t inertial{};
      stamp(inertial, tick);
      const double at_rest[] = {up_E.y(), -up_E.x(), up_E.z()};  // turned by 90 degrees about z
      for (int i = 0; i < 3; ++i) {
        inertial.acceleration[i] = at_rest[i] + 0.03 * noise();
        inertial.angular_velocity[i] = 0.002 * noise();
      }
      inertial_.publish(inertial);
    }
  }

  std::unique_ptr<bus::MessageBus> bus_;
  bus::TypedSubscription<twist_command_t> command_;
  bus::TypedPublisher<robot_state_t> state_;
  bus::TypedPublisher<ft_wrench_t> wrench_;
  bus::TypedPublisher<imu_t> inertial_;
  bool obeys_;
  Eigen::Isometry3d X_WE_ = Eigen::Isometry3d::Identity();
  twist_command_t last_{};
  int silence_ = kPatience;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace palpate
