#include "rt/config/bus_keys.hpp"

#include <gtest/gtest.h>

#include "tests/unit/rt/config/error_of.hpp"

namespace palpate::config {
namespace {

bus::ChannelNames names_of(const std::string& channels) {
  return read_channel_names(
      Node::from_text("bus: {channels: " + channels + "}").child_or_empty("bus"));
}

std::string refusal(const std::string& channels) {
  return error_of([&] { names_of(channels); });
}

TEST(ChannelNames, AreReadByPalpatesName) {
  EXPECT_TRUE(read_channel_names(Node::from_text("bus: {}").child("bus")).empty());
  const bus::ChannelNames names = names_of("{FT_WRENCH: LEFT_FT, BIOTAC_3: TIP, IMU_1: IMU2}");
  EXPECT_EQ(names,
            (bus::ChannelNames{{"FT_WRENCH", "LEFT_FT"}, {"BIOTAC_3", "TIP"}, {"IMU_1", "IMU2"}}));
  EXPECT_EQ(names_of("{IMU: IMU_1, IMU_1: IMU}").size(), 2U) << "exchanged";
}

TEST(ChannelNames, ThatAreUnknownWrongOrTakenAreRefused) {
  EXPECT_NE(refusal("{FT: LEFT_FT}").find("bus.channels.FT: is no channel of palpate; allowed: "),
            std::string::npos);
  EXPECT_NE(refusal("{BIOTAC: TIP}").find("BIOTAC_0"), std::string::npos) << "needs its number";
  EXPECT_NE(refusal("{IMU_2: TIP}").find("is no channel"), std::string::npos);
  EXPECT_NE(refusal("{FT_WRENCH: left/ft}").find("A-Z, 0-9 and _"), std::string::npos);
  EXPECT_NE(refusal("{FT_WRENCH: IMU}").find("IMU is the name of IMU"), std::string::npos);
  EXPECT_NE(refusal("{FT_WRENCH: A, IMU: A}").find("A is the name of"), std::string::npos);
  EXPECT_NE(refusal("{SHAPE: TRUTH_SHAPE}").find("TRUTH_SHAPE"), std::string::npos);
}

TEST(ChannelNames, OwnNamesFollowFromThoseOnTheBus) {
  const bus::ChannelNames names{{"FT_WRENCH", "LEFT_FT"}};
  EXPECT_EQ(bus::own_name(names, "LEFT_FT"), "FT_WRENCH");
  EXPECT_EQ(bus::own_name(names, "IMU"), "IMU");
  EXPECT_EQ(bus::own_name(names, "FT_WRENCH"), "") << "of another program";
  EXPECT_EQ(bus::own_name({}, "FT_WRENCH"), "FT_WRENCH");
}

}  // namespace
}  // namespace palpate::config
