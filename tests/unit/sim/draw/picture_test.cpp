#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "sim/draw/annotate.hpp"
#include "sim/draw/image.hpp"

namespace palpate::draw {
namespace {

Image pattern() {
  Image image(37, 21);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = std::uint8_t(i * 31 % 251);
  return image;
}

std::string file_in_temporary_folder(const std::string& name) {
  return ::testing::TempDir() + "palpate_picture_test_" + name;
}

TEST(Png, ReadsBackWhatWasWritten) {
  const Image image = pattern();
  const std::string path = file_in_temporary_folder("pattern.png");
  write_png(path, image);
  const Image back = read_png(path);
  EXPECT_EQ(back.width, image.width);
  EXPECT_EQ(back.height, image.height);
  EXPECT_EQ(back.rgb, image.rgb);
  std::remove(path.c_str());
}

TEST(Png, FailuresNameTheFile) {
  const std::string path = file_in_temporary_folder("no_such_folder/a.png");
  try {
    write_png(path, pattern());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos);
  }
  EXPECT_THROW(read_png(path), std::runtime_error);
  EXPECT_THROW(write_png(path, Image()), std::runtime_error);
}

int dark_pixels(const Image& image) {
  int count = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) count += image.rgb[i] < 128;
  return count;
}

TEST(Annotate, TextFillsItsBoxAndIsCutAtTheBorder) {
  Image image(200, 50);
  std::fill(image.rgb.begin(), image.rgb.end(), std::uint8_t{255});
  EXPECT_EQ(text_width("|", 2), 10);
  EXPECT_EQ(text_width("ab", 3), 33);
  draw_text(image, 10, 20, "|", {0, 0, 0, 1}, 2);
  EXPECT_EQ(dark_pixels(image), 2 * text_height(2));  // one column of dots
  EXPECT_EQ(image.pixel(14, 20)[0], 0);
  EXPECT_EQ(image.pixel(14, 33)[0], 0);
  EXPECT_EQ(image.pixel(14, 34)[0], 255);
  draw_text(image, 190, 45, "CUT OFF", {0, 0, 0, 1}, 4);
  draw_text(image, -300, -5, "cut off \xc3\xa9", {0, 0, 0, 1}, 4);
  EXPECT_GT(dark_pixels(image), 28);
}

TEST(Annotate, LegendShowsItsColours) {
  Image image(320, 240);
  draw_legend(image, {{"truth", {0, 1, 0, 1}}, {"estimate", {0, 0, 1, 1}}});
  int green = 0;
  int blue = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    green += image.rgb[i] == 0 && image.rgb[i + 1] == 255;
    blue += image.rgb[i] == 0 && image.rgb[i + 2] == 255;
  }
  EXPECT_EQ(green, 28 * 14);
  EXPECT_EQ(blue, 28 * 14);
}

TEST(Annotate, ColourMapBrightensEvenly) {
  double last = -1;
  for (int i = 0; i <= 20; ++i) {
    const Colour c = colour_map(i / 20.0);
    const double luminance = 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
    EXPECT_GT(luminance, last);
    last = luminance;
  }
  EXPECT_EQ(colour_map(-3).red, colour_map(0).red);
  EXPECT_EQ(colour_map(7).red, colour_map(1).red);
  EXPECT_EQ(colour_map(std::nan("")).red, colour_map(0).red);
}

}  // namespace
}  // namespace palpate::draw
