#include "tools/common/plot.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/drawn_curve.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::common {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

class PlotTest : public testing::Test {
 protected:
  std::string drawn(const Curve& curve, const std::string& name, bool logarithmic = false) {
    draw({{"Time", "nodes", "ms", {curve}, logarithmic, logarithmic}}, folder_.path() / name);
    return support::text_of(folder_.path() / name);
  }

  support::ScratchFolder folder_;
};

TEST_F(PlotTest, IsAPictureOfTheKindThatItsNameSays) {
  const Curve curve{"a curve's <title> costs $1 or $2", {0, 1, 2}, {3, 5, 4}};
  EXPECT_EQ(drawn(curve, "a.png").substr(1, 3), "PNG");
  const std::string svg = drawn(curve, "a.svg");
  for (const char* part : {"<svg", ">a curve's &lt;title&gt; costs $1 or $2<", ">nodes<", ">ms<"})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
}

// Points on a power law lie on a straight line, each decade as wide as the other.
TEST_F(PlotTest, HasAxesByPowersOfTen) {
  std::string numbers =
      support::first_curve(drawn({"", {1, 10, 1000}, {1, 100, 1e6}}, "a.svg", true));
  numbers = std::regex_replace(numbers, std::regex("[ML]"), " ");
  std::istringstream in(numbers);
  double x[3], y[3];
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(in >> x[k] >> y[k]) << numbers;
  EXPECT_NEAR(2 * (x[1] - x[0]), x[2] - x[1], 1);
  EXPECT_NEAR(2 * (y[1] - y[0]), y[2] - y[1], 1);
}

TEST_F(PlotTest, ACurveIsInterruptedWhereItHasNoValue) {
  const auto strokes = [this](double middle) {
    const std::string svg = drawn({"", {0, 1, 2, 3, 4}, {1, 2, middle, 2, 1}}, "a.svg");
    return support::strokes_of(support::first_curve(svg));
  };
  EXPECT_EQ(strokes(1), 1);
  EXPECT_EQ(strokes(kNone), 2);
}

TEST_F(PlotTest, APictureThatCannotBeMadeIsAnErrorOrAMessage) {
  const auto nowhere = folder_.path() / "no_such_folder/a.png";
  EXPECT_THROW(draw({{"", "", "", {{"", {0}, {0}}}}}, nowhere), std::runtime_error);
  testing::internal::CaptureStderr();
  EXPECT_FALSE(try_draw({{"", "", "", {{"", {0}, {0}}}}}, nowhere));
  EXPECT_NE(testing::internal::GetCapturedStderr().find("no_such_folder"), std::string::npos);
}

}  // namespace
}  // namespace palpate::common
