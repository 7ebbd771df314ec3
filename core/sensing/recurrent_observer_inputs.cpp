#include "core/sensing/recurrent_observer_inputs.hpp"

#include <Eigen/Geometry>

namespace palpate::sensing {
namespace {

struct Entry {
  const char* name;
  const char* unit;
};

constexpr Entry kEntries[kObserverInputCount] = {
    {"orientation_x", "1"},
    {"orientation_y", "1"},
    {"orientation_z", "1"},
    {"orientation_w", "1"},
    {"velocity_x", "m/s"},
    {"velocity_y", "m/s"},
    {"velocity_z", "m/s"},
    {"rate_x", "rad/s"},
    {"rate_y", "rad/s"},
    {"rate_z", "rad/s"},
    {"acceleration_x", "m/s^2"},
    {"acceleration_y", "m/s^2"},
    {"acceleration_z", "m/s^2"},
    {"gravity_x", "1"},
    {"gravity_y", "1"},
    {"gravity_z", "1"},
    {"velocity_S_x", "m/s"},
    {"velocity_S_y", "m/s"},
    {"velocity_S_z", "m/s"},
    {"rate_S_x", "rad/s"},
    {"rate_S_y", "rad/s"},
    {"rate_S_z", "rad/s"},
    {"rate_change_S_x", "rad/s^2"},
    {"rate_change_S_y", "rad/s^2"},
    {"rate_change_S_z", "rad/s^2"},
    {"position_x", "m"},
    {"position_y", "m"},
    {"position_z", "m"},
};

}  // namespace

const char* observer_input_name(int index) noexcept {
  return index >= 0 && index < kObserverInputCount ? kEntries[index].name : "";
}

const char* observer_input_unit(int index) noexcept {
  return index >= 0 && index < kObserverInputCount ? kEntries[index].unit : "";
}

int observer_input_index(const std::string& name) noexcept {
  for (int i = 0; i < kObserverInputCount; ++i)
    if (name == kEntries[i].name) return i;
  return -1;
}

ObserverInputs observer_inputs(const math::Pose& X_WS, const Eigen::Vector3d& velocity_W,
                               const LoadMotion& motion, const Eigen::Vector3d& gravity_W,
                               const Eigen::Vector4d& previous) noexcept {
  const Eigen::Matrix3d R_WS = X_WS.linear();
  Eigen::Vector4d quaternion = Eigen::Quaterniond(R_WS).coeffs();
  const double likeness = previous.squaredNorm() > 0 ? quaternion.dot(previous) : quaternion.w();
  if (likeness < 0) quaternion = -quaternion;
  ObserverInputs inputs;
  inputs.segment<4>(0) = quaternion;
  inputs.segment<3>(4) = velocity_W;
  inputs.segment<3>(7) = R_WS * motion.angular_velocity;
  inputs.segment<3>(10) = motion.specific_force;
  inputs.segment<3>(13) = R_WS.transpose() * gravity_W.normalized();
  inputs.segment<3>(16) = R_WS.transpose() * velocity_W;
  inputs.segment<3>(19) = motion.angular_velocity;
  inputs.segment<3>(22) = motion.angular_acceleration;
  inputs.segment<3>(25) = X_WS.translation();
  return inputs;
}

}  // namespace palpate::sensing
