#include "sim/scenes/sensor_publisher.hpp"

#include <algorithm>
#include <iterator>
#include <palpate/channels.hpp>

namespace palpate::scenes {

SensorPublisher::SensorPublisher(bus::MessageBus& control, std::int64_t session,
                                 std::int64_t start_utime, int arm)
    : start_utime_(start_utime),
      ft_(control, channel::of_arm(channel::kFtWrench, arm), session),
      imu_(control, channel::of_arm(channel::kImu, arm), session),
      robot_(control, channel::of_arm(channel::kRobotState, arm), session),
      hand_(control, channel::of_arm(channel::kHandState, arm), session) {
  for (int i = 0; i < sensors::kMostFingertips; ++i) {
    const std::string finger = std::to_string(i);
    biotacs_.emplace_back(control, channel::of_arm("BIOTAC_" + finger, arm), session);
    fingertips_.emplace_back(control, channel::of_arm("FINGERTIP_" + finger, arm), session);
  }
}

void SensorPublisher::publish(const sensors::RobotReading& reading) {
  robot_state_t message{};
  message.joint_count = static_cast<std::int32_t>(reading.q.size());
  std::copy_n(reading.q.data(), reading.q.size(), message.q);
  std::copy_n(reading.dq.data(), reading.dq.size(), message.dq);
  std::copy_n(reading.tau.data(), reading.tau.size(), message.tau);
  Eigen::Map<Eigen::Vector3d>(message.position) = reading.X_WE.translation();
  math::wxyz_from_rotation(reading.X_WE.linear(), message.quaternion);
  Eigen::Map<math::Vector6d>(message.twist) = reading.V_W_E.vector();
  robot_.publish(message, start_utime_ + reading.time_us);
}

void SensorPublisher::publish(const sensors::HandReading& reading) {
  hand_state_t message{};
  message.grasp = hand_state_t::GRASP_NONE;
  if (reading.holding) message.grasp = hand_state_t::GRASP_HOLDING;
  if (reading.holding && reading.slipping) message.grasp = hand_state_t::GRASP_SLIPPING;
  message.fingertip_count = static_cast<std::int32_t>(reading.X_ET.size());
  for (auto& quaternion : message.fingertip_quaternion) quaternion[0] = 1;
  for (std::size_t i = 0; i < reading.X_ET.size(); ++i) {
    Eigen::Map<Eigen::Vector3d>(message.fingertip_position[i]) = reading.X_ET[i].translation();
    math::wxyz_from_rotation(reading.X_ET[i].linear(), message.fingertip_quaternion[i]);
  }
  message.joint_count = std::min<int>(reading.q.size(), std::size(message.q));
  std::copy_n(reading.q.data(), message.joint_count, message.q);
  hand_.publish(message, start_utime_ + reading.time_us);
}

void SensorPublisher::publish(int finger, const sensors::BiotacReading& reading) {
  biotac_t message{};
  message.valid = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC |
                  biotac_t::VALID_TEMPERATURE;
  std::copy(reading.electrodes.begin(), reading.electrodes.end(), message.electrodes);
  message.pac_count = sensors::kVibrationSamples;
  std::copy(reading.pac.begin(), reading.pac.end(), message.pac);
  message.pdc = reading.pdc;
  message.tac = reading.tac;
  message.tdc = reading.tdc;
  biotacs_[finger].publish(message, start_utime_ + reading.time_us);
}

void SensorPublisher::publish(int finger, const sensors::FingertipReading& reading) {
  fingertip_t message{};
  message.contact = reading.contact ? 1 : 0;
  Eigen::Map<Eigen::Vector3d>(message.place) = reading.place;
  Eigen::Map<Eigen::Vector3d>(message.normal) = reading.normal;
  Eigen::Map<Eigen::Vector3d>(message.force) = reading.force;
  message.place_deviation = reading.place_deviation;
  message.force_deviation = reading.force_deviation;
  message.area = reading.area;
  fingertips_[finger].publish(message, start_utime_ + reading.time_us);
}

void SensorPublisher::publish(sensors::SensorSuite& suite, std::int64_t now_us) {
  sensors::RobotReading robot;
  while (suite.take(now_us, robot)) publish(robot);
  sensors::HandReading hand;
  while (suite.take(now_us, hand)) publish(hand);
  sensors::BiotacReading biotac;
  sensors::FingertipReading fingertip;
  for (int i = 0; i < sensors::kMostFingertips; ++i) {
    while (suite.take(now_us, i, biotac)) publish(i, biotac);
    while (suite.take(now_us, i, fingertip)) publish(i, fingertip);
  }
  sensors::InertialReading inertial;
  while (suite.take(now_us, inertial)) {
    imu_t message{};
    Eigen::Map<Eigen::Vector3d>(message.acceleration) = inertial.motion.head<3>();
    Eigen::Map<Eigen::Vector3d>(message.angular_velocity) = inertial.motion.tail<3>();
    imu_.publish(message, start_utime_ + inertial.time_us);
  }
  sensors::ForceTorqueReading wrench;
  while (suite.take(now_us, wrench)) {
    ft_wrench_t message{};
    Eigen::Map<math::Vector6d>(message.wrench) = wrench.wrench;
    ft_.publish(message, start_utime_ + wrench.time_us);
  }
}

}  // namespace palpate::scenes
