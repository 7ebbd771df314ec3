#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/log/record.hpp"

namespace palpate::exporting {

/// JSON schema of a type as append_json() writes it; units and comments in the descriptions.
nlohmann::ordered_json json_schema(const log::TypeInfo& type);

/// Appends a message as JSON: numbers as such (null if not finite), texts as strings, hashes as
/// hexadecimal strings, bytes in base64, arrays up to their length in use. Each entry of a
/// two-dimensional array is an object {"values": [...]}, since Foxglove does not support arrays of
/// arrays.
void append_json(const log::Record& record, std::string& text);

/// Appends a quoted JSON string; invalid UTF-8 bytes become question marks.
void append_json_string(const std::string& value, std::string& text);

}  // namespace palpate::exporting
