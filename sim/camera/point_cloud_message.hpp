#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/camera/point_cloud.hpp"

namespace palpate::camera {

/// Encodes the LCM message drake/lcmt_point_cloud (Drake 1.0 and later) of points without order:
/// little-endian float32 `x`, `y`, `z`, and `rgb`, a word of the bytes red, green, blue and 0; 16
/// bytes a point. `frame`: name of the frame of the points. `utime`: time of the exposure, us.
std::vector<std::uint8_t> encode_point_cloud(const ColouredCloud& cloud, const std::string& frame,
                                             std::int64_t utime);

}  // namespace palpate::camera
