#include "tools/record/log_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include "rt/bus/event_log_reader.hpp"

namespace palpate::record {
namespace {

constexpr double kMegabyte = 1e6;
constexpr int kMostNumbers = 100'000;

[[noreturn]] void fail(const std::string& path, const std::string& doing, int error) {
  throw std::runtime_error(path + ": cannot be " + doing + ": " + std::strerror(error));
}

std::string numbered(const std::string& name, int number, bool two_digits) {
  const std::string digits = std::to_string(number);
  return name + "." + (two_digits && digits.size() < 2 ? "0" : "") + digits;
}

/// Creates the file; false if it already exists.
bool make(const std::string& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd >= 0) {
    ::close(fd);
    return true;
  }
  if (errno != EEXIST) fail(path, "made", errno);
  return false;
}

}  // namespace

std::string labelled(const std::string& name, const std::string& label) {
  const std::filesystem::path path(name);
  const std::string extension = path.extension().string();
  const std::string stem = path.stem().string();
  return (path.parent_path() /
          (stem + "." + label + (extension.empty() ? std::string(".lcmlog") : extension)))
      .string();
}

std::string by_time(const std::string& pattern, std::int64_t now) {
  const std::time_t time = now;
  std::tm local{};
  localtime_r(&time, &local);
  std::array<char, 4096> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), pattern.c_str(), &local);
  if (size == 0) throw std::invalid_argument("\"" + pattern + "\" gives no name by strftime");
  return {text.data(), size};
}

LogFiles::LogFiles(std::string name, const LogFileOptions& options)
    : name_(std::move(name)), options_(options) {
  if (options.split_mb > 0 && options.rotate == 0 && !options.increment)
    throw std::invalid_argument("--split-mb needs --increment or --rotate");
  if (options.increment && (options.rotate > 0 || options.force))
    throw std::invalid_argument("--increment goes neither with --rotate nor with --force");
  open();
}

LogFiles::~LogFiles() = default;

void LogFiles::open() {
  if (options_.rotate > 0) {
    rotate();
    path_ = numbered(name_, 0, false);
  } else {
    path_ = new_file();
  }
  log_.reset(lcm_eventlog_create(path_.c_str(), "w"));
  if (!log_) fail(path_, "written", errno);
  ++opened_;
  bytes_before_ += bytes_;
  bytes_ = 0;
}

std::string LogFiles::new_file() {
  if (!options_.increment) {
    if (!make(name_) && !options_.force)
      throw std::runtime_error(name_ +
                               ": is there already; --force overwrites it, --increment "
                               "finds another name");
    return name_;
  }
  for (; next_number_ < kMostNumbers; ++next_number_) {
    const std::string path = numbered(name_, next_number_, true);
    if (!make(path)) continue;
    ++next_number_;
    return path;
  }
  throw std::runtime_error(name_ + ": all names up to ." + std::to_string(kMostNumbers) +
                           " are taken");
}

void LogFiles::rotate() {
  namespace fs = std::filesystem;
  std::error_code error;
  for (int i = options_.rotate - 1; i > 0; --i) {
    const std::string from = numbered(name_, i - 1, false);
    if (!fs::exists(fs::symlink_status(from, error))) continue;
    fs::rename(from, numbered(name_, i, false), error);
    if (error) fail(from, "renamed", error.value());
  }
}

void LogFiles::write(std::int64_t utime, std::string_view channel, const std::uint8_t* data,
                     int size) {
  std::string name(channel);
  lcm_eventlog_event_t event{};
  event.timestamp = utime;
  event.channellen = static_cast<std::int32_t>(name.size());
  event.channel = name.data();
  event.datalen = size;
  event.data = const_cast<std::uint8_t*>(data);
  errno = 0;
  if (lcm_eventlog_write_event(log_.get(), &event) != 0)
    fail(path_, "written", errno != 0 ? errno : EIO);
  bytes_ += bus::kEventHeaderSize + static_cast<std::int64_t>(name.size()) + size;
  if (options_.split_mb > 0 && static_cast<double>(bytes_) >= options_.split_mb * kMegabyte)
    split();
}

void LogFiles::flush() {
  if (log_ && std::fflush(log_->f) != 0) fail(path_, "written", errno);
}

void LogFiles::split() {
  if (!log_ || (options_.rotate == 0 && !options_.increment)) return;
  close();
  open();
}

void LogFiles::close() {
  if (!log_) return;
  flush();
  log_.reset();
  if (options_.rotate == 0) finished_.push_back(path_);
}

std::vector<std::string> LogFiles::files() const {
  if (options_.rotate == 0) {
    std::vector<std::string> all = finished_;
    if (log_) all.push_back(path_);
    return all;
  }
  std::vector<std::string> kept;
  for (int i = std::min(opened_, options_.rotate) - 1; i >= 0; --i)
    kept.push_back(numbered(name_, i, false));
  return kept;
}

}  // namespace palpate::record
