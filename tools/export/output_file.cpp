#include "tools/export/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace palpate::exporting {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)), buffer_(1 << 18) {
  std::error_code ignored;  // errors are reported when opening
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), ignored);
  out_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  out_.open(part(), std::ios::binary | std::ios::trunc);
  if (!out_) fail(path_);
}

OutputFile::~OutputFile() {
  if (!out_.is_open()) return;
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(part(), ignored);
}

void OutputFile::write(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out_) fail(path_);
  written_ += static_cast<std::int64_t>(bytes.size());
}

void OutputFile::finish() {
  out_.close();
  if (!out_) fail(path_);
  std::filesystem::rename(part(), path_);
}

}  // namespace palpate::exporting
