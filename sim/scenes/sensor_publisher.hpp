#pragma once

#include <cstdint>
#include <palpate/biotac_t.hpp>
#include <palpate/fingertip_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>

#include "rt/bus/stamped_publisher.hpp"
#include "sim/sensors/sensor_suite.hpp"

namespace palpate::scenes {

/// Publishes sensor readings that have arrived as messages on the control bus. utime is the time of
/// sampling: start_utime plus simulated time.
class SensorPublisher {
 public:
  /// Of arm 0 or 1.
  SensorPublisher(bus::MessageBus& control, std::int64_t session, std::int64_t start_utime,
                  int arm = 0);
  void start_clock(std::int64_t start_utime) { start_utime_ = start_utime; }

  /// Publishes all readings that have arrived by `now_us`.
  void publish(sensors::SensorSuite& suite, std::int64_t now_us);

 private:
  void publish(const sensors::RobotReading& reading);
  void publish(const sensors::HandReading& reading);
  void publish(int finger, const sensors::BiotacReading& reading);
  void publish(int finger, const sensors::FingertipReading& reading);

  std::int64_t start_utime_;
  bus::StampedPublisher<ft_wrench_t> ft_;
  bus::StampedPublisher<imu_t> imu_;
  bus::StampedPublisher<robot_state_t> robot_;
  bus::StampedPublisher<hand_state_t> hand_;
  std::vector<bus::StampedPublisher<biotac_t>> biotacs_;
  std::vector<bus::StampedPublisher<fingertip_t>> fingertips_;
};

}  // namespace palpate::scenes
