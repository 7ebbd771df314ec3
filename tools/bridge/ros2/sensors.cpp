#include "sensors.hpp"

#include <cmath>

namespace palpate::ros2_bridge {
namespace {

constexpr std::uint32_t kMostFields = 64;
constexpr std::uint64_t kMostCloudBytes = 60'000'000;   // below the bound of DDS samples
constexpr std::uint8_t kUint32 = 6, kFloat32 = 7;       // PointField.datatype
constexpr std::int64_t kIsBigEndian = 1, kIsDense = 2;  // lcmt_point_cloud.flags

bool put(const Vector3& from, double* to) {
  to[0] = from.x, to[1] = from.y, to[2] = from.z;
  return std::isfinite(to[0]) && std::isfinite(to[1]) && std::isfinite(to[2]);
}

/// The field of lcm's type. A uint32 colour is PCL's word, as which palpate-see knows float32.
drake::lcmt_point_cloud_field field_of(const PointField& from) {
  drake::lcmt_point_cloud_field to;
  to.name = from.name;
  to.byte_offset = static_cast<std::int32_t>(from.offset);
  const bool is_colour = to.name == "rgb" || to.name == "rgba";
  to.datatype =
      static_cast<std::int8_t>(is_colour && from.datatype == kUint32 ? kFloat32 : from.datatype);
  to.count = static_cast<std::int32_t>(from.count);
  return to;
}

}  // namespace

const char* convert(const WrenchStamped& from, int polarity, ft_wrench_t& to) {
  const bool is_finite =
      put(from.wrench.force, to.wrench) && put(from.wrench.torque, to.wrench + 3);
  for (double& number : to.wrench) number *= polarity;
  return is_finite ? nullptr : "the wrench is not finite";
}

const char* convert(const Imu& from, imu_t& to) {
  // REP 145: -1 says that the quantity is not measured.
  if (from.linear_acceleration_covariance[0] == -1 || from.angular_velocity_covariance[0] == -1)
    return "has no acceleration or no angular velocity";
  const bool is_finite = put(from.linear_acceleration, to.acceleration) &&
                         put(from.angular_velocity, to.angular_velocity);
  return is_finite ? nullptr : "acceleration or angular velocity are not finite";
}

const char* convert(const PointCloud2& from, drake::lcmt_point_cloud& to) {
  const std::uint64_t needed = from.height == 0 ? 0
                                                : std::uint64_t{from.row_step} * (from.height - 1) +
                                                      std::uint64_t{from.point_step} * from.width;
  if (from.fields._length == 0 || from.fields._length > kMostFields)
    return "the cloud has no fields, or more than 64";
  if (from.data._length > kMostCloudBytes) return "the cloud has more than 60 MB";
  if (needed > from.data._length) return "the cloud has fewer bytes than its size says";
  if (from.height > 1 && from.row_step < std::uint64_t{from.point_step} * from.width)
    return "the cloud's rows are shorter than their points";
  to.frame_name = from.header.frame_id;
  to.width = from.width;
  to.height = from.height;
  to.fields.clear();
  for (std::uint32_t i = 0; i < from.fields._length; ++i) {
    const PointField& field = from.fields._buffer[i];
    if (field.offset >= from.point_step) return "a field of the cloud lies outside of its points";
    to.fields.push_back(field_of(field));
  }
  to.num_fields = static_cast<std::int32_t>(to.fields.size());
  to.flags = (from.is_bigendian ? kIsBigEndian : 0) | (from.is_dense ? kIsDense : 0);
  to.point_step = static_cast<std::int32_t>(from.point_step);
  to.row_step = from.row_step;
  to.filler_size = 0;
  to.filler.clear();
  to.data_size = from.data._length;
  to.data.assign(from.data._buffer, from.data._buffer + from.data._length);
  return nullptr;
}

}  // namespace palpate::ros2_bridge
