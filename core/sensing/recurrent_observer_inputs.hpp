#pragma once

#include <Eigen/Core>
#include <string>

#include "core/sensing/payload.hpp"

namespace palpate::sensing {

/// Possible inputs of a network that observes the disturbance of a wrist sensor, in this order:
/// orientation_{x,y,z,w} (unit quaternion of S in W), velocity_{x,y,z} (m/s) and rate_{x,y,z}
/// (rad/s) in W, acceleration_{x,y,z} (specific force a - g in S, m/s^2), gravity_{x,y,z} (unit
/// vector in S), velocity_S_{x,y,z}, rate_S_{x,y,z} in S, rate_change_S_{x,y,z} (rad/s^2),
/// position_{x,y,z} (m, of S in W).
inline constexpr int kObserverInputCount = 28;
using ObserverInputs = Eigen::Matrix<double, kObserverInputCount, 1>;

/// Name of an input, "" if the index is invalid; index of a name, -1 if unknown.
const char* observer_input_name(int index) noexcept;
int observer_input_index(const std::string& name) noexcept;
/// "1", "m", "m/s", "rad/s", "m/s^2" or "rad/s^2".
const char* observer_input_unit(int index) noexcept;

/// Inputs from the motion of the sensor. The sign of the quaternion is the one nearer to `previous`
/// (x, y, z, w), or that with w >= 0 if `previous` is zero, so that it is continuous for a rotating
/// sensor.
ObserverInputs observer_inputs(const math::Pose& X_WS, const Eigen::Vector3d& velocity_W,
                               const LoadMotion& motion, const Eigen::Vector3d& gravity_W,
                               const Eigen::Vector4d& previous) noexcept;

}  // namespace palpate::sensing
