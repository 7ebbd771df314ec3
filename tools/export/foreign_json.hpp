#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/types/decoder.hpp"

namespace palpate::exporting {

/// JSON Schema of the messages of a described type as append_json() writes them. A struct within
/// itself is an object without properties.
nlohmann::ordered_json json_schema(const types::Struct& type);

/// Appends a message as one JSON object: arrays within arrays are objects {"values": [...]}, which
/// Foxglove takes, blocks of bytes are base64, numbers that are not finite are null. False, and
/// nothing appended, unless the message fits.
bool append_json(const types::Struct& type, const void* data, int size, std::string& text);

}  // namespace palpate::exporting
