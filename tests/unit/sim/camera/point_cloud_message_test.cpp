#include "sim/camera/point_cloud_message.hpp"

#include <gtest/gtest.h>

namespace palpate::camera {
namespace {

std::vector<std::uint8_t> bytes_of(const std::string& hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

TEST(PointCloudMessage, IsThePublishedLayoutByteByByte) {
  ColouredCloud cloud{Eigen::Matrix3Xf(3, 2), {255, 128, 0, 1, 2, 3}};
  cloud.points << 1, -2, 0.5F, 0, 2, 4;  // (1, 0.5, 2) and (-2, 0, 4)
  const std::string expected =
      "17f2c128b5d25a95"  // fingerprint
      "0000000000000102"  // utime
      "00000004"          // length of the frame's name with its zero
      "63616d00"          // "cam"
      "0000000000000002"  // width
      "0000000000000001"  // height
      "00000004"          // fields: name, byte_offset, datatype, count
      "000000027800"
      "00000000"
      "07"
      "00000001"
      "000000027900"
      "00000004"
      "07"
      "00000001"
      "000000027a00"
      "00000008"
      "07"
      "00000001"
      "0000000472676200"
      "0000000c"
      "06"
      "00000001"
      "0000000000000002"                  // flags: all are finite
      "00000010"                          // point_step
      "0000000000000020"                  // row_step
      "0000"                              // filler_size
      "0000000000000020"                  // data_size
      "0000803f0000003f00000040ff800000"  // little-endian 1, 0.5, 2; red, green, blue, 0
      "000000c0000000000000804001020300";
  EXPECT_EQ(encode_point_cloud(cloud, "cam", 0x102), bytes_of(expected));
}

TEST(PointCloudMessage, MayBeEmpty) {
  const auto message = encode_point_cloud({Eigen::Matrix3Xf(3, 0), {}}, "camera", 1);
  EXPECT_EQ(message.size(), 8u + 8 + 11 + 8 + 8 + 4 + 3 * 15 + 17 + 8 + 4 + 8 + 2 + 8);
}

}  // namespace
}  // namespace palpate::camera
