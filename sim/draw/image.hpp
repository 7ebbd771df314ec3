#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpate::draw {

/// Colour with opacity, each in [0, 1].
struct Colour {
  float red = 0;
  float green = 0;
  float blue = 0;
  float alpha = 1;
};

/// Colour image: 8-bit red, green, blue; row-major from the top, no padding.
struct Image {
  Image() = default;
  Image(int image_width, int image_height)
      : width(image_width),
        height(image_height),
        rgb(std::size_t(3) * image_width * image_height) {}

  std::uint8_t* pixel(int column, int row) { return &rgb[3 * (std::size_t(row) * width + column)]; }
  const std::uint8_t* pixel(int column, int row) const {
    return &rgb[3 * (std::size_t(row) * width + column)];
  }

  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Copies `part` into `whole`, with its upper left corner at this place in px; it must fit.
void paste(const Image& part, int column, int row, Image& whole);

/// Depth image: distance along the optical axis in m, row-major from the top; 0 marks no
/// measurement.
struct DepthImage {
  float at(int column, int row) const { return metres[std::size_t(row) * width + column]; }

  int width = 0;
  int height = 0;
  std::vector<float> metres;
};

/// Both throw std::runtime_error naming the file and the reason.
void write_png(const std::string& path, const Image& image);
Image read_png(const std::string& path);

}  // namespace palpate::draw
