#include "conversions.hpp"

#include <cmath>

namespace palpate::ros2_bridge {

std::optional<std::int64_t> utime_of(const Time& stamp) {
  if (stamp.sec < 0 || stamp.nanosec >= 1'000'000'000) return std::nullopt;
  return std::int64_t{1'000'000} * stamp.sec + stamp.nanosec / 1000;
}

Time stamp_of(std::int64_t utime) {
  return {static_cast<std::int32_t>(utime / 1'000'000),
          static_cast<std::uint32_t>(1000 * (utime % 1'000'000))};
}

Pose pose_message(const double* position, const double* wxyz) {
  return {{position[0], position[1], position[2]}, {wxyz[1], wxyz[2], wxyz[3], wxyz[0]}};
}

Pose pose_message(const math::Pose& X) {
  double wxyz[4];
  math::wxyz_from_rotation(X.linear(), wxyz);
  const Eigen::Vector3d position = X.translation();
  return pose_message(position.data(), wxyz);
}

std::optional<math::Pose> pose_of(const Pose& message) {
  const Eigen::Vector3d position(message.position.x, message.position.y, message.position.z);
  const double wxyz[4] = {message.orientation.w, message.orientation.x, message.orientation.y,
                          message.orientation.z};
  if (!position.allFinite() || !math::is_unit_quaternion(wxyz)) return std::nullopt;
  math::Pose X = math::Pose::Identity();
  X.translation() = position;
  X.linear() = math::rotation_from_wxyz(wxyz);
  return X;
}

}  // namespace palpate::ros2_bridge
