#include "sim/camera/point_cloud_message.hpp"

#include <cstring>
#include <iterator>
#include <utility>

namespace palpate::camera {
namespace {

// Layout of the type, in network order after its fingerprint: utime (int64), frame_name (length
// with its zero, int32, and text), width, height (int64), num_fields (int32), the fields, each of
// name, byte_offset (int32), datatype (int8) and count (int32); flags (int64), point_step (int32),
// row_step (int64), filler_size (int16) and its bytes, data_size (int64) and its bytes.
constexpr std::uint64_t kFingerprint = 0x17f2c128b5d25a95;  // hash of names and types by lcm-gen
constexpr std::int8_t kUint32 = 6, kFloat32 = 7;            // of datatype
constexpr std::int64_t kAllFinite = 2;                      // of flags; without 1: little-endian
constexpr int kPointStep = 16;                              // bytes

struct Field {
  const char* name;
  std::int32_t offset;  // bytes
  std::int8_t datatype;
};
constexpr Field kFields[] = {
    {"x", 0, kFloat32}, {"y", 4, kFloat32}, {"z", 8, kFloat32}, {"rgb", 12, kUint32}};

class Writer {
 public:
  template <class Integer>
  void number(Integer value) {
    const auto bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
    for (int shift = 8 * static_cast<int>(sizeof(Integer)) - 8; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
  void text(const std::string& value) {
    number(static_cast<std::int32_t>(value.size() + 1));
    bytes.insert(bytes.end(), value.begin(), value.end());
    bytes.push_back(0);
  }
  void little_endian(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    for (int shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  }

  std::vector<std::uint8_t> bytes;
};

}  // namespace

std::vector<std::uint8_t> encode_point_cloud(const ColouredCloud& cloud, const std::string& frame,
                                             std::int64_t utime) {
  const std::int64_t count = cloud.points.cols(), size = kPointStep * count;
  Writer to;
  to.bytes.reserve(static_cast<std::size_t>(size) + frame.size() + 256);
  to.number(static_cast<std::int64_t>(kFingerprint));
  to.number(utime);
  to.text(frame);
  to.number(count);
  to.number(std::int64_t{1});  // rows
  to.number(static_cast<std::int32_t>(std::size(kFields)));
  for (const Field& field : kFields) {
    to.text(field.name);
    to.number(field.offset);
    to.number(field.datatype);
    to.number(std::int32_t{1});
  }
  to.number(kAllFinite);
  to.number(std::int32_t{kPointStep});
  to.number(size);             // of a row
  to.number(std::int16_t{0});  // filler
  to.number(size);             // of the data
  for (Eigen::Index i = 0; i < count; ++i) {
    for (const float coordinate : cloud.points.col(i)) to.little_endian(coordinate);
    for (int channel = 0; channel < 3; ++channel)
      to.bytes.push_back(cloud.rgb[3 * static_cast<std::size_t>(i) + channel]);
    to.bytes.push_back(0);
  }
  return std::move(to.bytes);
}

}  // namespace palpate::camera
