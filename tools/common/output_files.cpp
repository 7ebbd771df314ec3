#include "tools/common/output_files.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace palpate::common {

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_cell(const nlohmann::json& value) {
  return csv_cell(value.is_string() ? value.get<std::string>() : value.dump());
}

std::string file_name(const std::string& title) {
  std::string name = title;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
}

nlohmann::json or_null(const std::optional<double>& value, double scale) {
  return value ? nlohmann::json(scale * *value) : nlohmann::json();
}

void write_json(const nlohmann::json& json, const std::filesystem::path& file) {
  if (file == "-") {
    std::cout << json.dump(2) << '\n' << std::flush;
    return;
  }
  std::ofstream out(file);
  out << json.dump(2) << '\n';
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

TemporaryFolder::TemporaryFolder(const std::string& prefix) {
  std::string name = (std::filesystem::temp_directory_path() / (prefix + "-XXXXXX")).string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be created");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace palpate::common
