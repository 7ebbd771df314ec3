#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

namespace palpate::exporting {  // "export" is a keyword of C++

/// A file that gets its name only when complete: until finish() it is called NAME.part, and an
/// unfinished file is removed.
class OutputFile {
 public:
  /// Creates the parent folders. Throws std::runtime_error naming the file and the reason.
  explicit OutputFile(std::filesystem::path path);
  OutputFile(OutputFile&&) = default;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  void write(std::string_view bytes);
  std::int64_t written() const { return written_; }  // bytes
  const std::filesystem::path& path() const { return path_; }

  /// Throws std::runtime_error if not everything could be written.
  void finish();

 private:
  std::filesystem::path part() const { return path_.string() + ".part"; }

  std::filesystem::path path_;
  std::vector<char> buffer_;
  std::ofstream out_;
  std::int64_t written_ = 0;
};

}  // namespace palpate::exporting
