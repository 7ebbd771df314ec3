#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "tests/support/recordings.hpp"
#include "tests/unit/lcmtypes/all_types.hpp"

namespace palpate {
namespace {

// A type must never change: recorded logs and other programs depend on it. To change NAME_t, keep
// it as NAME_v1_t (v2, ...), convert it in rt/bus/checked_decode.cpp, and list both here.
const std::map<std::string, std::uint64_t> kFingerprints = {
    {"biotac_t", 0x899d567d1460611d},
    {"compensated_wrench_t", 0x769a2a47c545168e},
    {"component_command_t", 0xfed930ff6db67de2},
    {"component_event_t", 0x1ee90f753de22690},
    {"config_t", 0x2528ab9c6b131a90},
    {"contacts_t", 0x9a783f5016ef363d},
    {"contacts_v1_t", 0x583cf81eabffd830},
    {"discrepancy_t", 0x5aa5cdf84dff8d46},
    {"estimate_t", 0x90fa6341cc59c8f8},
    {"feature_t", 0xf23c7d64d85a9291},
    {"fingertip_t", 0x34b9ee41d2edf592},
    {"ft_wrench_t", 0x9b49e504acb98a29},
    {"hand_command_t", 0x628acb59069e93ad},
    {"hand_state_t", 0x84fa12702593254e},
    {"health_t", 0xb788c9f8763f3fc1},
    {"health_v1_t", 0x920d206a9e87f31c},
    {"imu_t", 0xe923169b4e838cb5},
    {"joint_velocity_command_t", 0xc9f58126e7f327c4},
    {"manual_force_t", 0x656fbfeab7f85232},
    {"obstacles_t", 0x8438eb44eb9a69db},
    {"picture_t", 0x7681bbd02f87a9e4},
    {"robot_state_t", 0xf807c166e5654f41},
    {"shape_mesh_t", 0x612366e6c632b951},
    {"shape_mesh_v1_t", 0x84e15fc0554b33a1},
    {"shape_observation_t", 0xa041042241a6c428},
    {"shape_t", 0xb9cb4ea61ff41833},
    {"shape_target_t", 0x54683987e3acef3e},
    {"shape_v1_t", 0x97b9268b0352c0c7},
    {"sim_tick_t", 0x522bb656c829fa02},
    {"tick_done_t", 0xa9d321bb3d3be9ab},
    {"touch_request_t", 0x1ef99f3a0b09afa4},
    {"touch_t", 0xe4cbbaf4eaa65cf4},
    {"truth_contact_t", 0x779c317d534d90e5},
    {"truth_touch_t", 0x740489c96fb161f2},
    {"twist_command_t", 0xd5e7535877b658a3},
    {"unknown_contact_t", 0xad5d9e013dad9d74},
    {"world_state_t", 0x92edbc9bf54da07e},
};

std::map<std::string, std::uint64_t> generated_fingerprints() {
  std::map<std::string, std::uint64_t> fingerprints;
  const auto add = [&](const auto& message) {
    fingerprints[message.getTypeName()] = static_cast<std::uint64_t>(message.getHash());
  };
  for_each_fixed_size_type(add);
  for_each_variable_size_type(add);
  return fingerprints;
}

TEST(LcmTypes, FingerprintsAreFrozen) {
  const auto generated = generated_fingerprints();
  for (const auto& [name, fingerprint] : kFingerprints) {
    ASSERT_EQ(generated.count(name), 1u) << name << " is gone";
    EXPECT_EQ(generated.at(name), fingerprint) << name << " has changed";
  }
  EXPECT_EQ(generated.size(), kFingerprints.size());
}

TEST(LcmTypes, FingerprintsDifferBetweenTypes) {
  std::set<std::uint64_t> unlike;
  for (const auto& [name, fingerprint] : kFingerprints) unlike.insert(fingerprint);
  EXPECT_EQ(unlike.size(), kFingerprints.size());
}

TEST(LcmTypes, EveryDefinitionIsListed) {
  const std::filesystem::path folder = std::filesystem::path(PALPATE_SOURCE_DIR) / "lcmtypes";
  std::set<std::string> defined, listed;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".lcm") defined.insert(entry.path().stem().string());
  }
  for (const auto& [name, fingerprint] : kFingerprints) listed.insert(name);
  EXPECT_EQ(defined, listed);
}

// Types with a vector or a string are not trivially copyable.
template <typename... Types>
constexpr bool kFixedSize = (std::is_trivially_copyable_v<Types> && ...);

static_assert(kFixedSize<ft_wrench_t, imu_t, robot_state_t, hand_state_t, biotac_t, fingertip_t,
                         shape_observation_t, shape_target_t, manual_force_t, component_command_t,
                         touch_request_t, sim_tick_t>,
              "all that the daemon receives has a fixed size");
static_assert(!kFixedSize<shape_t>, "the check recognises variable sizes");

TEST(LcmTypes, FixedSizesFitOneDatagram) {
  constexpr int kDatagram = 60000;  // bytes
  int largest = 0;
  for_each_fixed_size_type([&](const auto& message) {
    static_assert(std::is_trivially_copyable_v<std::decay_t<decltype(message)>>);
    EXPECT_LT(message.getEncodedSize(), kDatagram) << message.getTypeName();
    largest = std::max(largest, message.getEncodedSize());
  });
  EXPECT_GE(largest, static_cast<int>(sizeof(shape_target_t::values)));
}

TEST(LcmTypes, EveryTypeStartsWithTimeSequenceAndSession) {
  const auto expect_header = [](auto message) {
    message.utime = 0x0102030405060708;
    message.seq = 0x090a0b0c;
    message.session = 0x0d0e0f1011121314;
    std::vector<std::uint8_t> bytes(message.getEncodedSize());
    ASSERT_GT(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    // Big endian, after the fingerprint.
    for (int i = 0; i < 20; ++i) EXPECT_EQ(bytes[8 + i], i + 1) << message.getTypeName();
  };
  for_each_fixed_size_type(expect_header);
  for_each_variable_size_type(expect_header);
}

}  // namespace
}  // namespace palpate
