#pragma once

#include <cstring>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::exporting {

/// Writes a log with LCM's own code.
class LogWriter {
 public:
  explicit LogWriter(const std::filesystem::path& file) : log_(file.string(), "w") {
    if (!log_.good()) throw std::runtime_error("cannot write " + file.string());
  }

  template <class Message>
  void write(const std::string& channel, std::int64_t utime, const Message& message) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    write_bytes(channel, utime, bytes);
  }

  void write_bytes(const std::string& channel, std::int64_t utime,
                   std::vector<std::uint8_t> bytes) {
    lcm::LogEvent event = {};
    event.timestamp = utime;
    event.channel = channel;
    event.datalen = static_cast<int>(bytes.size());
    event.data = bytes.data();
    if (log_.writeEvent(&event) != 0) throw std::runtime_error("cannot write an event");
  }

 private:
  lcm::LogFile log_;
};

}  // namespace palpate::exporting
