#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::serve {

/// A binary WebSocket message: the length of a JSON text (u32), that text padded with blanks to a
/// multiple of four bytes, and then arrays of 4-byte numbers, all little-endian. The text's entry
/// "arrays" lists them in order: name, "f32" or "i32", and length.
class Parcel {
 public:
  explicit Parcel(nlohmann::json head) : head_(std::move(head)) {
    head_["arrays"] = nlohmann::json::array();
  }
  /// The values are read by finish(): they must exist until then.
  void add(const std::string& name, const std::vector<float>& values);
  void add(const std::string& name, const std::vector<std::int32_t>& values);
  std::string finish();

 private:
  void append(const std::string& name, const char* type, const void* data, std::size_t count);
  nlohmann::json head_;
  std::vector<std::string_view> arrays_;  // bytes
};

/// Any text of a message, with arbitrary bytes, as JSON.
std::string dump(const nlohmann::json& json);
/// A mesh's hash in JSON, whose numbers do not hold 64 bits.
std::string hash_text(std::int64_t hash);

}  // namespace palpate::serve
