#include "tools/common/plot.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace palpate::common {
namespace {

std::string drawn(const std::string& name) {
  Plot plot;
  plot.title = "Time";
  plot.x_label = "nodes";
  plot.curves = {{"a curve's title", {1, 10, 1000}, {1, 100, 1e6}, false}};
  plot.logarithmic = plot.logarithmic_x = true;
  const auto picture = std::filesystem::path(testing::TempDir()) / name;
  if (!draw({plot}, picture)) return "";
  std::ifstream in(picture, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  EXPECT_FALSE(text.str().empty());
  std::filesystem::remove(picture);
  return text.str();
}

TEST(Plot, IsAPictureOfTheKindThatItsNameSays) {
  const std::string png = drawn("palpate_plot_test.png"), svg = drawn("palpate_plot_test.svg");
  if (png.empty()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_NE(svg.find("a curve's title"), std::string::npos);
}

// Points on a power law lie on a straight line, each decade as wide as the other.
TEST(Plot, HasAxesByPowersOfTen) {
  const std::string svg = drawn("palpate_plot_axes.svg");
  if (svg.empty()) GTEST_SKIP() << "gnuplot is not installed";
  const std::size_t group = svg.find("a curve's title");
  const std::size_t path = svg.find(" d='M", group);
  ASSERT_NE(path, std::string::npos);
  // The first stroke is the key's.
  std::string numbers = svg.substr(path + 5, svg.find('\'', path + 5) - path - 5);
  numbers.erase(0, numbers.rfind('M') + 1);
  for (char& c : numbers)
    if (c == ',' || c == 'L') c = ' ';
  std::istringstream in(numbers);
  double x[3], y[3];
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(in >> x[k] >> y[k]) << numbers;
  EXPECT_NEAR(2 * (x[1] - x[0]), x[2] - x[1], 1);
  EXPECT_NEAR(2 * (y[1] - y[0]), y[2] - y[1], 1);
}

}  // namespace
}  // namespace palpate::common
