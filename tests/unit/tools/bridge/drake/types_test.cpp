#include <gtest/gtest.h>

#include <drake/lcmt_force_torque.hpp>
#include <drake/lcmt_iiwa_command.hpp>
#include <drake/lcmt_iiwa_status.hpp>
#include <drake/lcmt_panda_command.hpp>
#include <drake/lcmt_panda_command_v1.hpp>
#include <drake/lcmt_panda_status.hpp>
#include <drake/lcmt_panda_status_v1.hpp>
#include <drake/lcmt_point_cloud.hpp>
#include <drake/lcmt_schunk_wsg_command.hpp>
#include <drake/lcmt_schunk_wsg_status.hpp>
#include <drake/lcmt_viewer_link_data.hpp>

namespace {

/// Without the types of its fields: as lcm-gen prints it.
template <class Message>
std::uint64_t own_hash() {
  const auto hash = static_cast<std::uint64_t>(Message::getHash());
  return hash >> 1 | hash << 63;
}

/// Of the drake package, 1.51, which process.drake compares; the former ones by Drake's
/// descriptions of 2020.
TEST(DrakeTypes, HaveTheFingerprintsOfDrake) {
  EXPECT_EQ(own_hash<drake::lcmt_iiwa_status>(), 0xf8b7dc0214255e51);
  EXPECT_EQ(own_hash<drake::lcmt_iiwa_command>(), 0x6ee3e3b9c640a99a);
  EXPECT_EQ(own_hash<drake::lcmt_panda_status>(), 0x0cab8e6fa6c17d73);
  EXPECT_EQ(own_hash<drake::lcmt_panda_command>(), 0x7346fbbb8026ace8);
  EXPECT_EQ(own_hash<drake::lcmt_panda_status_v1>(), 0xdda45a1d35abc249);
  EXPECT_EQ(own_hash<drake::lcmt_panda_command_v1>(), 0xbcfb518467ca7a24);
  EXPECT_EQ(own_hash<drake::lcmt_schunk_wsg_status>(), 0x7635771fe2d72309);
  EXPECT_EQ(own_hash<drake::lcmt_schunk_wsg_command>(), 0x22a9de0dffa4c90b);
  EXPECT_EQ(own_hash<drake::lcmt_force_torque>(), 0xb990321c992db2e2);
  EXPECT_EQ(static_cast<std::uint64_t>(drake::lcmt_point_cloud::getHash()), 0x17f2c128b5d25a95);
  EXPECT_EQ(own_hash<drake::lcmt_viewer_geometry_data>(), 0xae971a65992bed83);
  EXPECT_EQ(own_hash<drake::lcmt_viewer_link_data>() - drake::lcmt_viewer_geometry_data::getHash(),
            0x4b645ec7a5743a2a);
}

}  // namespace
