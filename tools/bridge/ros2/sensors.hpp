#pragma once

#include <drake/lcmt_point_cloud.hpp>
#include <functional>
#include <palpate/channels.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <string>
#include <utility>

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

/// A channel of palpate's by a topic of ROS 2: every reading, with its stamp.
template <class From, class To>
class SensorRelay {
 public:
  /// `convert`: as above.
  SensorRelay(const Participant& participant, const std::string& topic, const Clock& clock,
              bus::MessageBus& control, const char* channel,
              std::function<const char*(const From&, To&)> convert)
      : messages_(participant, {topic, Quality::kStream, kDepth}),
        intake_(topic, clock),
        readings_(control, channel, bus::random_session()),
        convert_(std::move(convert)) {}

  /// Passes on what has arrived. `utime`: us, system time.
  void cycle(std::int64_t utime) {
    while (const From* const message = messages_.next()) {
      To reading{};
      if (const char* const reason = convert_(*message, reading))
        intake_.refuse(reason);
      else if (const auto sent = intake_.admit(message->header.stamp, utime))
        readings_.publish(reading, *sent);
    }
  }
  Intake& intake() { return intake_; }

 private:
  static constexpr int kDepth = 64;  // of a cycle that is late

  Reader<From> messages_;
  Intake intake_;
  bus::StampedPublisher<To> readings_;
  std::function<const char*(const From&, To&)> convert_;
};

/// FT_WRENCH.
class WrenchRelay final : public SensorRelay<WrenchStamped, ft_wrench_t> {
 public:
  WrenchRelay(const Participant& participant, const std::string& topic, int polarity,
              const Clock& clock, bus::MessageBus& control)
      : SensorRelay(participant, topic, clock, control, channel::kFtWrench,
                    [polarity](const WrenchStamped& from, ft_wrench_t& to) {
                      return convert(from, polarity, to);
                    }) {}
};

/// IMU.
class ImuRelay final : public SensorRelay<Imu, imu_t> {
 public:
  ImuRelay(const Participant& participant, const std::string& topic, const Clock& clock,
           bus::MessageBus& control)
      : SensorRelay(participant, topic, clock, control, channel::kImu,
                    [](const Imu& from, imu_t& to) { return convert(from, to); }) {}
};

}  // namespace palpate::ros2_bridge
