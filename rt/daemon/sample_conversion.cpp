#include "rt/daemon/sample_conversion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rt/bus/text.hpp"

namespace palpate::daemon {
namespace {

/// Larger than any force, speed and length of a robot cell in SI units, hence not a measurement.
/// Larger finite numbers would overflow when squared.
constexpr double kLargest = 1e6;

bool all_plausible(const double* numbers, int count) noexcept {
  for (int i = 0; i < count; ++i) {
    if (!(std::abs(numbers[i]) <= kLargest)) return false;
  }
  return true;
}

double seconds(std::int64_t utime) noexcept { return static_cast<double>(utime) * 1e-6; }

}  // namespace

bool convert(const ft_wrench_t& m, sensing::ForceTorque& out) noexcept {
  if (!all_plausible(m.wrench, 6)) return false;
  out.time = seconds(m.utime);
  out.F_S = math::Wrench::from(Eigen::Map<const math::Vector6d>(m.wrench));
  return true;
}

bool convert(const imu_t& m, sensing::Inertial& out) noexcept {
  if (!all_plausible(m.acceleration, 3) || !all_plausible(m.angular_velocity, 3)) return false;
  out.time = seconds(m.utime);
  out.acceleration_I = Eigen::Map<const Eigen::Vector3d>(m.acceleration);
  out.angular_velocity_I = Eigen::Map<const Eigen::Vector3d>(m.angular_velocity);
  return true;
}

bool convert(const robot_state_t& m, sensing::RobotState& out) noexcept {
  if (m.joint_count < 0 || m.joint_count > 16 || !all_plausible(m.q, m.joint_count) ||
      !all_plausible(m.dq, m.joint_count) || !all_plausible(m.position, 3) ||
      !all_plausible(m.twist, 6) || !math::is_unit_quaternion(m.quaternion)) {
    return false;
  }
  out.time = seconds(m.utime);
  out.joint_count = m.joint_count;
  out.q = Eigen::Map<const Eigen::Matrix<double, 16, 1>>(m.q);
  out.dq = Eigen::Map<const Eigen::Matrix<double, 16, 1>>(m.dq);
  // Pose and joints are of use without torques.
  out.tau = Eigen::Map<const Eigen::Matrix<double, 16, 1>>(m.tau);
  if (!all_plausible(m.tau, m.joint_count))
    out.tau.setConstant(std::numeric_limits<double>::quiet_NaN());
  out.X_WE.linear() = math::rotation_from_wxyz(m.quaternion);
  out.X_WE.translation() = Eigen::Map<const Eigen::Vector3d>(m.position);
  out.V_W_E = math::Twist::from(Eigen::Map<const math::Vector6d>(m.twist));
  return true;
}

bool convert(const hand_state_t& m, sensing::HandState& out) noexcept {
  if (m.fingertip_count < 0 || m.fingertip_count > 5 || m.grasp < hand_state_t::GRASP_NONE ||
      m.grasp > hand_state_t::GRASP_SLIPPING) {
    return false;
  }
  for (int i = 0; i < m.fingertip_count; ++i) {
    if (!all_plausible(m.fingertip_position[i], 3) ||
        !math::is_unit_quaternion(m.fingertip_quaternion[i])) {
      return false;
    }
    out.X_ET[i].linear() = math::rotation_from_wxyz(m.fingertip_quaternion[i]);
    out.X_ET[i].translation() = Eigen::Map<const Eigen::Vector3d>(m.fingertip_position[i]);
  }
  out.time = seconds(m.utime);
  out.grasp = static_cast<sensing::Grasp>(m.grasp);
  out.fingertip_count = m.fingertip_count;
  return true;
}

bool convert(const manual_force_t& m, sensing::ManualForce& out) noexcept {
  if (!all_plausible(m.rest_point, 3) || !all_plausible(m.force, 3)) return false;
  out.rest_point_O = Eigen::Map<const Eigen::Vector3d>(m.rest_point);
  out.force_O = Eigen::Map<const Eigen::Vector3d>(m.force);
  return true;
}

/// The twist is also bounded because the obstacle keeps it until the next message.
bool convert(const world_state_t& m, sensing::ObstacleState& out) noexcept {
  constexpr double kFastest = 10, kFastestTurn = 50;  // m/s, rad/s
  if (!all_plausible(m.position, 3) || !all_plausible(m.twist, 6) ||
      !math::is_unit_quaternion(m.quaternion))
    return false;
  out.V_W_B = math::Twist::from(Eigen::Map<const math::Vector6d>(m.twist));
  if (out.V_W_B.linear.norm() > kFastest || out.V_W_B.angular.norm() > kFastestTurn) return false;
  out.time = seconds(m.utime);
  bus::put_text(out.name, bus::get_text(m.name));
  out.X_WB.linear() = math::rotation_from_wxyz(m.quaternion);
  out.X_WB.translation() = Eigen::Map<const Eigen::Vector3d>(m.position);
  return true;
}

bool convert(const biotac_t& m, sensing::BioTac& out) noexcept {
  constexpr int kNeeded = biotac_t::VALID_ELECTRODES | biotac_t::VALID_PAC | biotac_t::VALID_PDC;
  if ((m.valid & kNeeded) != kNeeded || m.pac_count < 1 || m.pac_count > 22) return false;
  out.time = seconds(m.utime);
  for (int i = 0; i < 19; ++i) out.electrodes[i] = m.electrodes[i];
  out.pac = m.pac[0];
  out.pdc = m.pdc;
  out.tac = m.tac;
  out.tdc = m.tdc;
  return true;
}

/// Deviations and area: known ones within what can be.
bool convert(const fingertip_t& m, sensing::FingertipContact& out) noexcept {
  constexpr double kFarthest = 0.5, kWidest = 1, kUnit = 1e-2;  // m, m^2
  const Eigen::Map<const Eigen::Vector3d> place(m.place), normal(m.normal);
  if (m.contact < 0 || m.contact > 1 || !all_plausible(m.force, 3)) return false;
  out = {};
  out.time = seconds(m.utime);
  out.force_T = Eigen::Map<const Eigen::Vector3d>(m.force);
  if (m.contact == 0) return true;
  if (!(place.norm() <= kFarthest) || !(std::abs(normal.norm() - 1) <= kUnit) ||
      !(m.place_deviation <= kFarthest) || !(m.force_deviation <= kLargest) || !(m.area <= kWidest))
    return false;
  out.touches = true;
  out.place_T = place;
  out.normal_T = normal.normalized();
  constexpr double kUnknown = -1;
  out.place_deviation = std::max(m.place_deviation, kUnknown);
  out.force_deviation = std::max(m.force_deviation, kUnknown);
  out.area = std::max(m.area, kUnknown);
  return true;
}

/// A camera that does not see the object publishes zero points: no information on the shape, but a
/// sign of life.
bool convert(const shape_observation_t& m, sensing::ShapeObservation& out) noexcept {
  constexpr double kCoarsest = 1;  // m, largest plausible deviation
  if (m.count < 0 || m.count > sensing::ShapeObservation::kMostPoints) return false;
  if (m.count > 0 && !(m.deviation > 0 && m.deviation <= kCoarsest)) return false;
  for (int i = 0; i < m.count; ++i) {
    for (const float x : m.points[i]) {
      if (!(std::abs(x) <= static_cast<float>(kLargest))) return false;
    }
    out.points_W.col(i) = Eigen::Map<const Eigen::Vector3f>(m.points[i]);
  }
  out.time = seconds(m.utime);
  out.count = m.count;
  out.deviation = m.deviation;
  return true;
}

}  // namespace palpate::daemon
