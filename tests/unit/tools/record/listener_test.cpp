#include <gtest/gtest.h>

#include "tools/record/listener.hpp"

namespace palpate::record {
namespace {

TEST(Sources, TakeThePlaceOfTheirLabelOrStandBehind) {
  std::vector<Source> sources = default_sources();
  put_urls({"control=udpm://239.1.2.3:1234", "second=udpm://239.1.2.4:1235?ttl=1"}, sources);
  ASSERT_EQ(sources.size(), 4u);
  EXPECT_EQ(sources[0].label, "control");
  EXPECT_EQ(sources[0].url.group(), "239.1.2.3:1234");
  EXPECT_EQ(sources[3].label, "second");
  EXPECT_EQ(sources[3].url.ttl, 1);
}

TEST(Sources, AUrlWithoutALabelIsThatOfControl) {
  std::vector<Source> sources;
  put_urls({"udpm://239.1.2.3:1234"}, sources);
  ASSERT_EQ(sources.size(), 1u);
  EXPECT_EQ(sources[0].label, "control");
}

TEST(Sources, WrongOnesAreNamed) {
  std::vector<Source> sources;
  for (const char* text : {"=udpm://239.1.2.3:1", "Up=udpm://239.1.2.3:1", "a/b=udpm://239.1.2.3:1",
                           "control=udpm://10.0.0.1:1", "control="}) {
    try {
      put_urls({text}, sources);
      FAIL() << text;
    } catch (const std::invalid_argument& error) {
      const std::string word = std::string(text).substr(std::string(text).find('=') + 1);
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
}

TEST(ChannelFilter, MatchesWholeNames) {
  ChannelFilter filter("SHAPE|HE.*");
  EXPECT_TRUE(filter.wants("SHAPE"));
  EXPECT_TRUE(filter.wants("HEALTH"));
  EXPECT_FALSE(filter.wants("SHAPE_MESH"));
  EXPECT_FALSE(filter.wants("SHAPE_MESH")) << "asked again";
  ChannelFilter others("SHAPE|HE.*", true);
  EXPECT_FALSE(others.wants("SHAPE"));
  EXPECT_TRUE(others.wants("SHAPE_MESH"));
  EXPECT_TRUE(ChannelFilter().wants("anything"));
  EXPECT_FALSE(ChannelFilter(".*", true).wants("anything"));
}

TEST(ChannelFilter, APatternThatIsNoneIsNamed) {
  try {
    ChannelFilter filter("SHAPE(");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("SHAPE("), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::record
