#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/draw/image.hpp"

namespace palpate::draw {

/// Each throws std::runtime_error that names the file and the reason. Encoding 640 x 480 takes
/// tens of milliseconds: not for a loop.
void write_png(const std::string& path, const Image& image);
Image read_png(const std::string& path);
std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace palpate::draw
