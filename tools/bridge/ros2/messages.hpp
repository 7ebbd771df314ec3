#pragma once

#include <ros2/messages.h>

#include <cstdint>
#include <string>
#include <vector>

// The types of idl/messages.idl by the names that ROS 2 gives them.

namespace palpate::ros2_bridge {

using Time = builtin_interfaces_msg_dds__Time_;
using Header = std_msgs_msg_dds__Header_;
using Float64MultiArray = std_msgs_msg_dds__Float64MultiArray_;
using String = std_msgs_msg_dds__String_;
using Point = geometry_msgs_msg_dds__Point_;
using Pose = geometry_msgs_msg_dds__Pose_;
using Vector3 = geometry_msgs_msg_dds__Vector3_;
using PointStamped = geometry_msgs_msg_dds__PointStamped_;
using PoseStamped = geometry_msgs_msg_dds__PoseStamped_;
using TwistStamped = geometry_msgs_msg_dds__TwistStamped_;
using WrenchStamped = geometry_msgs_msg_dds__WrenchStamped_;
using JointState = sensor_msgs_msg_dds__JointState_;
using Imu = sensor_msgs_msg_dds__Imu_;
using PointField = sensor_msgs_msg_dds__PointField_;
using PointCloud2 = sensor_msgs_msg_dds__PointCloud2_;
using Marker = visualization_msgs_msg_dds__Marker_;
using KeyValue = diagnostic_msgs_msg_dds__KeyValue_;
using DiagnosticStatus = diagnostic_msgs_msg_dds__DiagnosticStatus_;
using DiagnosticArray = diagnostic_msgs_msg_dds__DiagnosticArray_;
using TriggerRequest = std_srvs_srv_dds__Trigger_Request_;
using TriggerResponse = std_srvs_srv_dds__Trigger_Response_;

/// Description of a type for DDS. `hash`: that of ROS 2 since Iron (REP 2016), which differs
/// between versions of a type; empty: not announced.
struct Type {
  const dds_topic_descriptor_t* descriptor;
  const char* hash;
};

// By the type of the (unused) pointer.
inline Type type_of(const Float64MultiArray*) {
  return {&std_msgs_msg_dds__Float64MultiArray__desc,
          "1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f"};
}
inline Type type_of(const String*) {
  return {&std_msgs_msg_dds__String__desc,
          "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"};
}
inline Type type_of(const PointStamped*) {
  return {&geometry_msgs_msg_dds__PointStamped__desc,
          "4c0296af86e01e562e9e0405d138a01537247580076c58ea38d7923ac1045897"};
}
inline Type type_of(const PoseStamped*) {
  return {&geometry_msgs_msg_dds__PoseStamped__desc,
          "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"};
}
inline Type type_of(const TwistStamped*) {
  return {&geometry_msgs_msg_dds__TwistStamped__desc,
          "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"};
}
inline Type type_of(const WrenchStamped*) {
  return {&geometry_msgs_msg_dds__WrenchStamped__desc,
          "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"};
}
inline Type type_of(const JointState*) {
  return {&sensor_msgs_msg_dds__JointState__desc,
          "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"};
}
inline Type type_of(const Imu*) {
  return {&sensor_msgs_msg_dds__Imu__desc,
          "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"};
}
inline Type type_of(const PointCloud2*) {
  return {&sensor_msgs_msg_dds__PointCloud2__desc,
          "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"};
}
inline Type type_of(const Marker*) {
  return {&visualization_msgs_msg_dds__Marker__desc,
          "45b13ccf791f225962bf74e746f9644518855d783a6f42ba0cc14fde2b4f3ce0"};
}
inline Type type_of(const DiagnosticArray*) {
  return {&diagnostic_msgs_msg_dds__DiagnosticArray__desc,
          "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"};
}
inline Type type_of(const TriggerRequest*) {
  return {&std_srvs_srv_dds__Trigger_Request__desc, ""};
}
inline Type type_of(const TriggerResponse*) {
  return {&std_srvs_srv_dds__Trigger_Response__desc, ""};
}

/// Has the sequence of a message that is sent refer to `items`, which stay where they are until
/// then.
template <class Sequence, class Item>
void refer(Sequence& sequence, std::vector<Item>& items) {
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(items.size());
  sequence._buffer = items.data();
  sequence._release = false;
}

}  // namespace palpate::ros2_bridge
