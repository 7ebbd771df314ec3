#include "rt/client/request.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "rt/bus/text.hpp"

namespace palpate::client {
namespace {

TEST(Request, BecomesACommand) {
  const component_command_t message =
      make_command({"replace", "sensing", "wrist", "ft_tare_only", "{gain: 2}"});
  EXPECT_STREQ(bus::get_text(message.event), "replace");
  EXPECT_STREQ(bus::get_text(message.slot), "sensing");
  EXPECT_STREQ(bus::get_text(message.instance), "wrist");
  EXPECT_STREQ(bus::get_text(message.component), "ft_tare_only");
  EXPECT_STREQ(bus::get_text(message.parameters), "{gain: 2}");
}

TEST(Request, IsNeverCut) {
  EXPECT_NO_THROW(make_command({"start", std::string(31, 'a'), "", "", ""}));
  EXPECT_THROW(make_command({"start", std::string(32, 'a'), "", "", ""}), std::invalid_argument);
  EXPECT_THROW(make_command({"replace", "all", "", "", std::string(2048, ' ')}),
               std::invalid_argument);
  EXPECT_THROW(make_target("point", std::vector<double>(4), {}), std::invalid_argument);
  EXPECT_THROW(make_target("points", std::vector<double>(3 * 513), std::vector<double>(3 * 513)),
               std::invalid_argument);
  EXPECT_THROW(make_target("points", {}, std::vector<double>(1537)), std::invalid_argument);
  EXPECT_THROW(make_target("points", std::vector<double>(3 * 65), std::vector<double>(3)),
               std::invalid_argument);
}

TEST(Request, TargetHoldsPointsByRowAndValues) {
  const std::vector<shape_target_t> messages = make_target("point", {1, 2, 3, 4, 5, 6}, {7, -8});
  ASSERT_EQ(messages.size(), 1U);
  const shape_target_t& message = messages[0];
  EXPECT_STREQ(bus::get_text(message.kind), "point");
  ASSERT_EQ(message.point_count, 2);
  EXPECT_EQ(message.rest_points[1][0], 4);
  EXPECT_EQ(message.rest_points[0][2], 3);
  ASSERT_EQ(message.value_count, 2);
  EXPECT_EQ(message.values[1], -8);
  EXPECT_EQ(message.chunks, 1);
}

TEST(Request, ALargeTargetIsDealtOutInFullChunks) {
  std::vector<double> points(3 * 130), values(3 * 130);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = static_cast<double>(i);
    values[i] = -static_cast<double>(i);
  }
  const std::vector<shape_target_t> chunks = make_target("points", points, values);
  ASSERT_EQ(chunks.size(), 3U);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(chunks[static_cast<std::size_t>(c)].chunk, c);
    EXPECT_EQ(chunks[static_cast<std::size_t>(c)].chunks, 3);
    EXPECT_EQ(chunks[static_cast<std::size_t>(c)].point_count, c < 2 ? 64 : 2);
    EXPECT_EQ(chunks[static_cast<std::size_t>(c)].value_count, c < 2 ? 192 : 6);
  }
  EXPECT_EQ(chunks[1].rest_points[0][0], 3 * 64);
  EXPECT_EQ(chunks[2].rest_points[1][2], 3 * 130 - 1);
  EXPECT_EQ(chunks[2].values[5], -(3 * 130 - 1));
  EXPECT_EQ(make_target("points", {}, values).back().point_count, 0);
}

TEST(Request, ParametersNestByDots) {
  const YAML::Node made = YAML::Load(
      make_parameters({"order=linear", "material.young_modulus=39e3", "material.poisson_ratio=0.3",
                       "points=[[1, 2, 3]]", "order=quadratic"}));
  EXPECT_EQ(made.size(), 3u);
  EXPECT_EQ(made["order"].as<std::string>(), "quadratic") << "the last one counts";
  EXPECT_EQ(made["material"]["young_modulus"].as<double>(), 39e3);
  EXPECT_EQ(made["material"]["poisson_ratio"].as<double>(), 0.3);
  EXPECT_EQ(made["points"][0][2].as<int>(), 3);
  EXPECT_EQ(make_parameters({}), "");
}

TEST(Request, ParametersWithoutKeyOrWithBrokenValuesAreRefused) {
  for (const char* wrong : {"order", "=3", "order=[1"})
    EXPECT_THROW(make_parameters({wrong}), std::invalid_argument) << wrong;
}

}  // namespace
}  // namespace palpate::client
