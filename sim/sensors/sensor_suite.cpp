#include "sim/sensors/sensor_suite.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate::sensors {
namespace {

/// Two vectors of a link L in the axes of a sensor that is mounted in it with R_LS.
math::Vector6d turned(const Eigen::Matrix3d& R_LS, const math::Vector6d& of_link) {
  math::Vector6d of_sensor;
  of_sensor << R_LS.transpose() * of_link.head<3>(), R_LS.transpose() * of_link.tail<3>();
  return of_sensor;
}

}  // namespace

SensorSuite::SensorSuite(const SensorTable& table, std::uint64_t seed, const math::Pose& X_EG,
                         int joint_count)
    : force_torque_(table.force_torque.timing, math::Random(seed, "force_torque")),
      imu_(table.imu.timing, math::Random(seed, "imu")),
      robot_(table.robot_state.timing, math::Random(seed, "robot_state")),
      hand_(table.hand_state.timing, math::Random(seed, "hand_state")),
      R_LS_(table.force_torque.mounting),
      R_LI_(table.imu.mounting),
      disturbance_(table.force_torque.disturbance),
      force_(table.force_torque.force, force_torque_.period(), table.force_torque.bias.head<3>(),
             math::Random(seed, "force")),
      torque_(table.force_torque.torque, force_torque_.period(), table.force_torque.bias.tail<3>(),
              math::Random(seed, "torque")),
      acceleration_(table.imu.acceleration, imu_.period(), table.imu.bias.head<3>(),
                    math::Random(seed, "acceleration")),
      angular_velocity_(table.imu.angular_velocity, imu_.period(), table.imu.bias.tail<3>(),
                        math::Random(seed, "angular_velocity")),
      joint_position_(table.robot_state.position, robot_.period(),
                      Eigen::VectorXd::Zero(joint_count), math::Random(seed, "joint_position")),
      joint_velocity_(table.robot_state.velocity, robot_.period(),
                      Eigen::VectorXd::Zero(joint_count), math::Random(seed, "joint_velocity")),
      joint_torque_(table.robot_state.torque, robot_.period(), Eigen::VectorXd::Zero(joint_count),
                    math::Random(seed, "joint_torque")),
      friction_(table.robot_state.friction, joint_count),
      X_EE_reported_(X_EG * table.kinematics_error * X_EG.inverse()) {
  const math::Random random(seed, "fingertips");
  for (int i = 0; i < kMostFingertips; ++i) {
    const std::string finger = std::to_string(i);
    fingertips_.emplace_back(table.hand_state.fingertip, hand_.period(), Eigen::Vector3d::Zero(),
                             random.split("fingertip" + finger));
    biotac_channels_.emplace_back(table.biotac.timing, math::Random(seed, "biotac_time" + finger));
    biotacs_.emplace_back(table.biotac, biotac_channels_.back().period(),
                          math::Random(seed, "biotac" + finger));
    fingertip_channels_.emplace_back(table.fingertip.timing,
                                     math::Random(seed, "fingertip_time" + finger));
    fingertip_sensors_.emplace_back(table.fingertip, fingertip_channels_.back().period(),
                                    math::Random(seed, "fingertip_sensor" + finger));
  }
}

math::Vector6d SensorSuite::disturbed_wrench(std::int64_t now_us, const Truth& truth) {
  if (!X_WS_first_) X_WS_first_ = truth.X_WS;
  const Eigen::Matrix3d R_LW = truth.X_WS.linear().transpose();
  // The reading is the force of the sensor against the cables.
  const math::Wrench cables{
      disturbance_.cable_stiffness * R_LW * (truth.X_WS.translation() - X_WS_first_->translation()),
      disturbance_.cable_torsion * R_LW *
          math::log_rotation(truth.X_WS.linear() * X_WS_first_->linear().transpose())};
  const double warm = 1 - std::exp(-1e-6 * static_cast<double>(now_us) / disturbance_.warm_up_time);
  return turned(R_LS_, truth.force_torque.wrench + cables.vector()) + warm * disturbance_.warm_up;
}

RobotReading SensorSuite::measure_robot(const Truth& truth) {
  RobotReading r;
  r.q = joint_position_.measure(truth.robot.q);
  r.dq = joint_velocity_.measure(truth.robot.dq);
  r.tau = joint_torque_.measure(truth.robot.tau + friction_.at(truth.robot.q, truth.robot.dq));
  // The encoder errors are so small that the flange moves by J (q_measured - q).
  const math::Vector6d moved = truth.jacobian * (r.q - truth.robot.q);
  const math::Pose X_WE =
      math::make_pose(math::exp_rotation(moved.tail<3>()) * truth.robot.X_WE.linear(),
                      truth.robot.X_WE.translation() + moved.head<3>());
  r.X_WE = X_WE * X_EE_reported_;
  const math::Vector6d faults = truth.jacobian * (r.dq - truth.robot.dq);
  r.V_W_E = math::move_reference(math::Twist::from(truth.robot.V_W_E.vector() + faults),
                                 X_WE.linear() * X_EE_reported_.translation());
  return r;
}

HandReading SensorSuite::measure_hand(const HandReading& truth) {
  HandReading r = truth;
  if (r.X_ET.size() > fingertips_.size())
    throw std::invalid_argument("a hand has five fingertips at most");
  for (std::size_t i = 0; i < r.X_ET.size(); ++i)
    r.X_ET[i].translation() = fingertips_[i].measure(truth.X_ET[i].translation());
  return r;
}

void SensorSuite::sample_fingertips(std::int64_t now_us,
                                    const std::vector<std::vector<Touch>>& touches) {
  if (touches.size() > biotacs_.size())
    throw std::invalid_argument("a hand has five fingertips at most");
  for (std::size_t i = 0; i < touches.size(); ++i) {
    biotacs_[i].step(1e-6 * static_cast<double>(now_us - last_us_), touches[i]);
    if (biotac_channels_[i].due(now_us)) {
      BiotacReading r = biotacs_[i].read();
      r.time_us = biotac_channels_[i].stamp(now_us);
      biotac_channels_[i].put(now_us, r);
    }
    if (fingertip_channels_[i].due(now_us)) {
      FingertipReading r = fingertip_sensors_[i].read(touches[i]);
      r.time_us = fingertip_channels_[i].stamp(now_us);
      fingertip_channels_[i].put(now_us, r);
    }
  }
  last_us_ = now_us;
}

void SensorSuite::sample(std::int64_t now_us, const Truth& truth) {
  if (force_torque_.due(now_us)) {
    ForceTorqueReading r{force_torque_.stamp(now_us), {}};
    const math::Vector6d wrench = disturbed_wrench(now_us, truth);
    r.wrench << force_.measure(wrench.head<3>()), torque_.measure(wrench.tail<3>());
    force_torque_.put(now_us, r);
  }
  if (imu_.due(now_us)) {
    InertialReading r{imu_.stamp(now_us), {}};
    const math::Vector6d motion = turned(R_LI_, truth.imu.motion);
    r.motion << acceleration_.measure(motion.head<3>()),
        angular_velocity_.measure(motion.tail<3>());
    imu_.put(now_us, r);
  }
  if (robot_.due(now_us)) {
    RobotReading r = measure_robot(truth);
    r.time_us = robot_.stamp(now_us);
    robot_.put(now_us, std::move(r));
  }
  if (hand_.due(now_us)) {
    HandReading r = measure_hand(truth.hand);
    r.time_us = hand_.stamp(now_us);
    hand_.put(now_us, std::move(r));
  }
  sample_fingertips(now_us, truth.touches);
}

}  // namespace palpate::sensors
