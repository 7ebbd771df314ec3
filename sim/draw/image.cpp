#include "sim/draw/image.hpp"

#include <png.h>

#include <algorithm>
#include <stdexcept>

namespace palpate::draw {
namespace {

[[noreturn]] void fail(const std::string& what, png_image& png) {
  const std::string reason = png.message;
  png_image_free(&png);
  throw std::runtime_error(what + ": " + reason);
}

}  // namespace

void paste(const Image& part, int column, int row, Image& whole) {
  for (int y = 0; y < part.height; ++y)
    std::copy_n(part.pixel(0, y), std::size_t(3) * part.width, whole.pixel(column, row + y));
}

void write_png(const std::string& path, const Image& image) {
  if (image.width < 1 || image.height < 1) throw std::runtime_error("PNG: the image is empty");
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  if (!png_image_write_to_file(&png, path.c_str(), 0, image.rgb.data(), 0, nullptr)) {
    fail("cannot write " + path, png);
  }
}

Image read_png(const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str())) fail("cannot read " + path, png);
  png.format = PNG_FORMAT_RGB;
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  if (!png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr)) {
    fail("cannot read " + path, png);
  }
  return image;
}

}  // namespace palpate::draw
