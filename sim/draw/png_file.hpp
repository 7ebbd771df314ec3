#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/draw/image.hpp"

namespace palpate::draw {

/// Both throw std::runtime_error naming the file and the reason. Encoding 640 x 480 pixels takes
/// tens of milliseconds: do not call in a control loop.
void write_png(const std::string& path, const Image& image);
Image read_png(const std::string& path);
std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace palpate::draw
