#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace palpate::evaluate {

/// A field of a line of comma-separated values, quoted where it has to be (RFC 4180).
std::string csv_cell(const std::string& text);
std::string csv_cell(const nlohmann::json& value);

}  // namespace palpate::evaluate
