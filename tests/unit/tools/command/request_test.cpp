#include "tools/command/request.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "rt/daemon/text.hpp"

namespace palpate::command {
namespace {

TEST(Request, BecomesACommand) {
  const component_command_t message =
      make_command({"replace", "sensing", "wrist", "ft_tare_only", "{gain: 2}"});
  EXPECT_STREQ(daemon::get_text(message.event), "replace");
  EXPECT_STREQ(daemon::get_text(message.slot), "sensing");
  EXPECT_STREQ(daemon::get_text(message.instance), "wrist");
  EXPECT_STREQ(daemon::get_text(message.component), "ft_tare_only");
  EXPECT_STREQ(daemon::get_text(message.parameters), "{gain: 2}");
}

TEST(Request, IsNeverCut) {
  EXPECT_NO_THROW(make_command({"start", std::string(31, 'a'), "", "", ""}));
  EXPECT_THROW(make_command({"start", std::string(32, 'a'), "", "", ""}), std::invalid_argument);
  EXPECT_THROW(make_command({"replace", "all", "", "", std::string(2048, ' ')}),
               std::invalid_argument);
  EXPECT_THROW(make_target("point", std::vector<double>(4), {}), std::invalid_argument);
  EXPECT_THROW(make_target("point", std::vector<double>(195), {}), std::invalid_argument);
  EXPECT_THROW(make_target("point", {}, std::vector<double>(193)), std::invalid_argument);
}

TEST(Request, TargetHoldsPointsByRowAndValues) {
  const shape_target_t message = make_target("point", {1, 2, 3, 4, 5, 6}, {7, -8});
  EXPECT_STREQ(daemon::get_text(message.kind), "point");
  ASSERT_EQ(message.point_count, 2);
  EXPECT_EQ(message.rest_points[1][0], 4);
  EXPECT_EQ(message.rest_points[0][2], 3);
  ASSERT_EQ(message.value_count, 2);
  EXPECT_EQ(message.values[1], -8);
  EXPECT_EQ(message.chunks, 1);
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
}  // namespace palpate::command
