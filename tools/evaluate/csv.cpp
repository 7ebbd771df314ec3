#include "tools/evaluate/csv.hpp"

#include <nlohmann/json.hpp>

namespace palpate::evaluate {

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_cell(const nlohmann::json& value) {
  return csv_cell(value.is_string() ? value.get<std::string>() : value.dump());
}

}  // namespace palpate::evaluate
