#include "tools/serve/parcel.hpp"

#include <cstdio>
#include <cstring>

namespace palpate::serve {

void Parcel::append(const std::string& name, const char* type, const void* data,
                    std::size_t count) {
  head_["arrays"].push_back({{"name", name}, {"type", type}, {"count", count}});
  arrays_.emplace_back(static_cast<const char*>(data), 4 * count);
}

void Parcel::add(const std::string& name, const std::vector<float>& values) {
  append(name, "f32", values.data(), values.size());
}

void Parcel::add(const std::string& name, const std::vector<std::int32_t>& values) {
  append(name, "i32", values.data(), values.size());
}

std::string Parcel::finish() {
  std::string text = dump(head_);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string whole(4, '\0');
  // x86-64 and all browsers' machines are little-endian.
  std::memcpy(whole.data(), &length, 4);
  std::size_t size = 4 + text.size();
  for (const std::string_view array : arrays_) size += array.size();
  whole.reserve(size);
  whole += text;
  for (const std::string_view array : arrays_) whole += array;
  return whole;
}

std::string dump(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string hash_text(std::int64_t hash) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace palpate::serve
