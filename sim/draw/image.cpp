#include "sim/draw/image.hpp"

#include <png.h>

#include <cstring>
#include <stdexcept>

namespace palpate::draw {
namespace {

png_image describe(const Image& image) {
  if (image.width < 1 || image.height < 1) throw std::runtime_error("PNG: the image is empty");
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  return png;
}

[[noreturn]] void fail(const std::string& what, png_image& png) {
  const std::string reason = png.message;
  png_image_free(&png);
  throw std::runtime_error(what + ": " + reason);
}

}  // namespace

void write_png(const std::string& path, const Image& image) {
  png_image png = describe(image);
  if (!png_image_write_to_file(&png, path.c_str(), 0, image.rgb.data(), 0, nullptr)) {
    fail("cannot write " + path, png);
  }
}

Image read_png(const std::string& path) {
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str())) fail("cannot read " + path, png);
  png.format = PNG_FORMAT_RGB;
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  if (!png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr)) {
    fail("cannot read " + path, png);
  }
  return image;
}

std::vector<std::uint8_t> encode_png(const Image& image) {
  png_image png = describe(image);
  std::vector<std::uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr)) {
    fail("cannot encode a PNG", png);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace palpate::draw
