#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace palpate::common {

/// A field of a line of comma-separated values, quoted if necessary (RFC 4180).
std::string csv_cell(const std::string& text);
std::string csv_cell(const nlohmann::json& value);

/// Name with everything but letters and digits as '_', for files.
std::string file_name(const std::string& title);

/// Throws std::runtime_error if the file cannot be written.
void write_json(const nlohmann::json& json, const std::filesystem::path& file);

/// `scale` times the value; null for none.
nlohmann::json or_null(const std::optional<double>& value, double scale = 1);

/// A folder for the files of one run, removed with its content at the end.
class TemporaryFolder {
 public:
  /// Its name begins with `prefix`. Throws std::runtime_error.
  explicit TemporaryFolder(const std::string& prefix);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate::common
