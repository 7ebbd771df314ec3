#include "tools/log/record.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace palpate::log {
namespace {

std::uint64_t big_endian(const std::uint8_t* bytes, int count) {
  std::uint64_t number = 0;
  for (int i = 0; i < count; ++i) number = number << 8 | bytes[i];
  return number;
}

template <class To, class From>
To as(From bits) {
  static_assert(sizeof(To) == sizeof(From));
  To value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

template <class Number>
void append(Number value, std::string& text) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end);
}

}  // namespace

Record::Record(const TypeInfo& type)
    : type_(&type), values_(type.fields.size()), used_(type.fields.size()) {}

bool Record::decode(const std::uint8_t* data, int size) {
  if (type_of(data, size) != type_) return false;
  std::int64_t place = 8;
  for (std::size_t f = 0; f < values_.size(); ++f) {
    const FieldInfo& field = type_->fields[f];
    std::int64_t count = 1;
    for (const int dimension : field.sizes) count *= dimension;
    if (field.length_field >= 0) count = integer(field.length_field, 0);
    const int width = size_of(field.primitive);
    if (count < 0 || count > (size - place) / width) return false;
    values_[f].resize(static_cast<std::size_t>(count));
    for (Value& value : values_[f]) {
      const std::uint64_t bits = big_endian(data + place, width);
      place += width;
      switch (field.primitive) {
        case Primitive::kByte:
          value.integer = static_cast<std::int64_t>(bits);
          break;
        case Primitive::kInt8:
          value.integer = static_cast<std::int8_t>(bits);
          break;
        case Primitive::kInt16:
          value.integer = static_cast<std::int16_t>(bits);
          break;
        case Primitive::kInt32:
          value.integer = static_cast<std::int32_t>(bits);
          break;
        case Primitive::kInt64:
          value.integer = static_cast<std::int64_t>(bits);
          break;
        case Primitive::kFloat:
          value.real = as<float>(static_cast<std::uint32_t>(bits));
          break;
        case Primitive::kDouble:
          value.real = as<double>(bits);
          break;
      }
    }
    used_[f] = static_cast<int>(count);
  }
  if (place != size) return false;
  for (std::size_t f = 0; f < values_.size(); ++f) {
    const FieldInfo& field = type_->fields[f];
    if (field.count_field < 0) continue;
    const std::int64_t rows =
        std::clamp<std::int64_t>(integer(field.count_field, 0), 0, field.sizes.front());
    used_[f] = static_cast<int>(rows) * field.row_size();
  }
  return true;
}

double Record::number(int field, int index) const {
  const Value& value = values_[field][index];
  const FieldInfo& info = type_->fields[field];
  return info.is_integer() || info.is_bytes() ? static_cast<double>(value.integer) : value.real;
}

void Record::append_number(int field, int index, std::string& text) const {
  const Value& value = values_[field][index];
  switch (type_->fields[field].primitive) {
    case Primitive::kFloat:
      append(static_cast<float>(value.real), text);
      break;
    case Primitive::kDouble:
      append(value.real, text);
      break;
    default:
      append(value.integer, text);
  }
}

int Record::texts(int field) const {
  const FieldInfo& info = type_->fields[field];
  return info.sizes.size() < 2 ? 1 : used_[field] / info.row_size();
}

std::string Record::text(int field, int row) const {
  const FieldInfo& info = type_->fields[field];
  const int length = info.sizes.size() < 2 ? size(field) : info.row_size();
  std::string result;
  for (int i = row * length; i < (row + 1) * length && integer(field, i) != 0; ++i)
    result += static_cast<char>(integer(field, i));
  return result;
}

std::string Record::hexadecimal(int field, int first, int count) const {
  static constexpr char kDigits[] = "0123456789abcdef";
  const int digits = 2 * size_of(type_->fields[field].primitive);
  std::string result;
  for (int i = first; i < first + count; ++i)
    for (int digit = digits - 1; digit >= 0; --digit)
      result += kDigits[integer(field, i) >> (4 * digit) & 0xf];
  return result;
}

void append_number(double value, std::string& text) { append(value, text); }
void append_number(float value, std::string& text) { append(value, text); }

}  // namespace palpate::log
