#include "tools/export/json_schema.hpp"

#include <algorithm>
#include <cmath>

#include "tools/common/base64.hpp"
#include "tools/export/columns.hpp"

namespace palpate::exporting {
namespace {

using Json = nlohmann::ordered_json;

std::string described(const log::FieldInfo& field) {
  std::string units, last;
  for (std::size_t i = 0; i < field.units.size(); ++i) {
    const std::string unit = unit_text(field, static_cast<int>(i));
    if (unit != last && !unit.empty()) units += (units.empty() ? "" : ", ") + unit;
    last = unit;
  }
  if (units.empty()) return field.comment;
  return field.comment.empty() ? units : units + "; " + field.comment;
}

Json element_schema(const log::FieldInfo& field) {
  if (field.is_text() || field.is_hash()) return {{"type", "string"}};
  if (field.is_bytes()) return {{"type", "string"}, {"contentEncoding", "base64"}};
  return {{"type", field.is_integer() ? "integer" : "number"}};
}

void append_value(const log::Record& record, int field, int index, std::string& text) {
  const log::FieldInfo& info = record.type().fields[field];
  if (info.is_hash())
    text += '"' + record.hexadecimal(field, index, 1) + '"';
  else if (!info.is_integer() && !std::isfinite(record.number(field, index)))
    text += "null";
  else
    record.append_number(field, index, text);
}

/// Numbers `first` to `last`, from dimension `depth` on.
void append_array(const log::Record& record, int field, std::size_t depth, int first, int last,
                  std::string& text) {
  const log::FieldInfo& info = record.type().fields[field];
  text += '[';
  int step = 1;
  for (std::size_t d = depth + 1; d < info.sizes.size(); ++d) step *= info.sizes[d];
  for (int i = first; i < last; i += step) {
    if (i > first) text += ',';
    if (depth + 1 < info.sizes.size()) {
      text += "{\"values\":";
      append_array(record, field, depth + 1, i, i + step, text);
      text += '}';
    } else {
      append_value(record, field, i, text);
    }
  }
  text += ']';
}

void append_field(const log::Record& record, int field, std::string& text) {
  const log::FieldInfo& info = record.type().fields[field];
  if (info.is_text()) {
    const bool is_list = info.sizes.size() > 1;
    if (is_list) text += '[';
    for (int row = 0; row < record.texts(field); ++row) {
      if (row > 0) text += ',';
      append_json_string(record.text(field, row), text);
    }
    if (is_list) text += ']';
  } else if (info.is_bytes()) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(record.used(field)));
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::uint8_t>(record.integer(field, static_cast<int>(i)));
    text += '"';
    text += common::to_base64(bytes.data(), bytes.size());
    text += '"';
  } else if (info.is_scalar()) {
    append_value(record, field, 0, text);
  } else {
    append_array(record, field, 0, 0, record.used(field), text);
  }
}

/// Number of bytes of the UTF-8 character that begins at `at`; 0 if it is invalid.
int utf8_length(const std::string& value, std::size_t at) {
  const auto byte = static_cast<unsigned char>(value[at]);
  const int length = byte < 0x80   ? 1
                     : byte < 0xc2 ? 0
                     : byte < 0xe0 ? 2
                     : byte < 0xf0 ? 3
                     : byte < 0xf5 ? 4
                                   : 0;
  if (length == 0 || at + static_cast<std::size_t>(length) > value.size()) return 0;
  for (int i = 1; i < length; ++i)
    if ((static_cast<unsigned char>(value[at + static_cast<std::size_t>(i)]) & 0xc0) != 0x80)
      return 0;
  const auto second = length > 2 ? static_cast<unsigned char>(value[at + 1]) : 0;
  const bool is_odd = (byte == 0xe0 && second < 0xa0) || (byte == 0xed && second > 0x9f) ||
                      (byte == 0xf0 && second < 0x90) || (byte == 0xf4 && second > 0x8f);
  return is_odd ? 0 : length;
}

}  // namespace

nlohmann::ordered_json json_schema(const log::TypeInfo& type) {
  Json properties = Json::object();
  Json required = Json::array();
  for (const log::FieldInfo& field : type.fields) {
    Json schema = element_schema(field);
    const bool is_string = field.is_text() || field.is_bytes();
    std::size_t dimensions = field.sizes.size();
    if (is_string && dimensions > 0) --dimensions;  // the last one is the string's own
    for (std::size_t d = 0; d < dimensions; ++d) {
      if (d > 0) schema = {{"type", "object"}, {"properties", {{"values", schema}}}};
      schema = {{"type", "array"}, {"items", schema}};
    }
    const std::string text = described(field);
    if (!text.empty()) schema["description"] = text;
    properties[field.name] = schema;
    required.push_back(field.name);
  }
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", "palpate." + type.name},
          {"description", type.comment},
          {"type", "object"},
          {"properties", properties},
          {"required", required}};
}

void append_json(const log::Record& record, std::string& text) {
  text += '{';
  const auto& fields = record.type().fields;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    if (f > 0) text += ',';
    text += '"' + fields[f].name + "\":";
    append_field(record, static_cast<int>(f), text);
  }
  text += '}';
}

void append_json_string(const std::string& value, std::string& text) {
  static constexpr char kDigits[] = "0123456789abcdef";
  text += '"';
  for (std::size_t i = 0; i < value.size();) {
    const auto byte = static_cast<unsigned char>(value[i]);
    const int length = utf8_length(value, i);
    if (byte == '"' || byte == '\\') {
      text += '\\';
      text += value[i];
    } else if (byte < 0x20) {
      text += "\\u00";
      text += kDigits[byte >> 4];
      text += kDigits[byte & 0xf];
    } else if (length == 0) {
      text += '?';
    } else {
      text.append(value, i, static_cast<std::size_t>(length));
    }
    i += static_cast<std::size_t>(std::max(length, 1));
  }
  text += '"';
}

}  // namespace palpate::exporting
