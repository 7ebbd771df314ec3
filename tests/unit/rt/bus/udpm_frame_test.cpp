#include "rt/bus/udpm_frame.hpp"

#include <gtest/gtest.h>

#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

FrameKind parse(const std::vector<std::uint8_t>& data, UdpmFrame& frame) {
  return parse_udpm_frame(data.data(), static_cast<int>(data.size()), frame);
}

TEST(UdpmFrame, FindsChannelAndPayload) {
  const auto data = wire::datagram("FT_WRENCH", {1, 2, 3});
  UdpmFrame frame{};
  ASSERT_EQ(parse(data, frame), FrameKind::kMessage);
  EXPECT_EQ(frame.channel, "FT_WRENCH");
  ASSERT_EQ(frame.payload_size, 3);
  EXPECT_EQ(frame.payload[0], 1);
  EXPECT_EQ(frame.payload[2], 3);
}

TEST(UdpmFrame, APayloadMayBeEmptyAndANameSixtyThreeLong) {
  const auto data = wire::datagram(std::string(63, 'A'), {});
  UdpmFrame frame{};
  ASSERT_EQ(parse(data, frame), FrameKind::kMessage);
  EXPECT_EQ(frame.channel.size(), 63u);
  EXPECT_EQ(frame.payload_size, 0);
}

TEST(UdpmFrame, DistinguishesAFragmentFromNonsense) {
  UdpmFrame frame{};
  EXPECT_EQ(parse(wire::datagram("A", {1}, "LC03"), frame), FrameKind::kFragment);
  EXPECT_EQ(parse(wire::datagram("A", {1}, "LC01"), frame), FrameKind::kMalformed);
  EXPECT_EQ(parse(wire::datagram("A", {1}, "XXXX"), frame), FrameKind::kMalformed);
  EXPECT_EQ(parse(wire::datagram("", {1}), frame), FrameKind::kMalformed);
  EXPECT_EQ(parse(wire::datagram(std::string(64, 'A'), {1}), frame), FrameKind::kMalformed);
}

TEST(UdpmFrame, NeverSeesMoreThanThereIs) {
  const auto whole = wire::datagram("FT_WRENCH", {1, 2, 3, 4, 5});
  const std::size_t name_ends = 8 + 9 + 1;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const std::vector<std::uint8_t> cut(whole.begin(),
                                        whole.begin() + static_cast<std::ptrdiff_t>(size));
    UdpmFrame frame{};
    const FrameKind kind = parse(cut, frame);
    if (size < name_ends) {
      EXPECT_EQ(kind, FrameKind::kMalformed) << size;
    } else {
      EXPECT_EQ(kind, FrameKind::kMessage) << size;
      EXPECT_EQ(frame.payload_size, static_cast<int>(size - name_ends));
    }
  }
}

}  // namespace
}  // namespace palpate::bus
