#pragma once

#include <drake/lcmt_point_cloud.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <string>

#include "intake.hpp"
#include "participant.hpp"
#include "rt/bus/stamped_publisher.hpp"

namespace palpate::ros2_bridge {

// Messages of sensors as palpate's, without their times. All return why a message is refused, a
// literal; nullptr: it is not.

/// `polarity`: 1 for the wrench on the hand, -1 for that of the surroundings on the sensor.
const char* convert(const WrenchStamped& from, int polarity, ft_wrench_t& to);
const char* convert(const Imu& from, imu_t& to);
/// The same bytes: lcmt_point_cloud describes them alike.
const char* convert(const PointCloud2& from, drake::lcmt_point_cloud& to);

/// FT_WRENCH by a topic of geometry_msgs/WrenchStamped.
class WrenchRelay {
 public:
  WrenchRelay(const Participant& participant, const std::string& topic, int polarity,
              const Clock& clock, bus::MessageBus& control);

  /// Passes on what has arrived. `utime`: us, system time.
  void cycle(std::int64_t utime);
  Intake& intake() { return intake_; }

 private:
  Reader<WrenchStamped> messages_;
  int polarity_;
  Intake intake_;
  bus::StampedPublisher<ft_wrench_t> wrenches_;
};

/// IMU by a topic of sensor_msgs/Imu.
class ImuRelay {
 public:
  ImuRelay(const Participant& participant, const std::string& topic, const Clock& clock,
           bus::MessageBus& control);

  void cycle(std::int64_t utime);
  Intake& intake() { return intake_; }

 private:
  Reader<Imu> messages_;
  Intake intake_;
  bus::StampedPublisher<imu_t> readings_;
};

}  // namespace palpate::ros2_bridge
