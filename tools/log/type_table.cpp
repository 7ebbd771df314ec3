#include "tools/log/type_table.hpp"

#include <unordered_map>

namespace palpate::log {

int size_of(Primitive primitive) {
  switch (primitive) {
    case Primitive::kInt8:
    case Primitive::kByte:
      return 1;
    case Primitive::kInt16:
      return 2;
    case Primitive::kInt32:
    case Primitive::kFloat:
      return 4;
    case Primitive::kInt64:
    case Primitive::kDouble:
      break;
  }
  return 8;
}

int FieldInfo::row_size() const {
  int size = 1;
  for (std::size_t i = 1; i < sizes.size(); ++i) size *= sizes[i];
  return size;
}

const std::string& FieldInfo::unit(int index) const {
  return units[static_cast<std::size_t>(index) % units.size()];
}

int TypeInfo::field(const std::string& field_name) const {
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].name == field_name) return static_cast<int>(i);
  return -1;
}

const TypeInfo* type_of(const std::uint8_t* data, int size) {
  static const auto kByFingerprint = [] {
    std::unordered_map<std::int64_t, const TypeInfo*> map;
    for (const TypeInfo& type : types()) map[type.fingerprint] = &type;
    return map;
  }();
  if (size < 8) return nullptr;
  std::uint64_t fingerprint = 0;
  for (int i = 0; i < 8; ++i) fingerprint = fingerprint << 8 | data[i];
  const auto found = kByFingerprint.find(static_cast<std::int64_t>(fingerprint));
  return found == kByFingerprint.end() ? nullptr : found->second;
}

}  // namespace palpate::log
