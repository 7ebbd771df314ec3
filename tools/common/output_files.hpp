#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace palpate::common {

/// A field of a line of comma-separated values, quoted if necessary (RFC 4180).
std::string csv_cell(const std::string& text);
std::string csv_cell(const nlohmann::json& value);

/// Name with everything but letters and digits as '_', for files.
std::string file_name(const std::string& title);

/// Throws std::runtime_error if the file cannot be written.
void write_json(const nlohmann::json& json, const std::filesystem::path& file);

}  // namespace palpate::common
