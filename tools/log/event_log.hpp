#pragma once

#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <palpate/component_event_t.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "rt/bus/text.hpp"

namespace palpate::log {

/// Writer of an LCM event log.
class EventLog {
 public:
  explicit EventLog(const std::filesystem::path& path) : path_(path.string()), file_(path_, "w") {
    if (!file_.good()) throw std::runtime_error(path_ + ": cannot be written");
  }

  /// `time_us`: of the log's own clock.
  template <class Message>
  void write(const std::string& channel, std::int64_t time_us, const Message& message) {
    buffer_.resize(message.getEncodedSize());
    message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
    write(channel, time_us, buffer_);
  }

  /// An encoded message, which is not changed.
  void write(const std::string& channel, std::int64_t time_us, std::vector<std::uint8_t>& message) {
    lcm::LogEvent event{};
    event.timestamp = time_us;
    event.channel = channel;
    event.datalen = static_cast<int>(message.size());
    event.data = message.data();
    if (file_.writeEvent(&event) != 0) throw std::runtime_error(path_ + ": cannot be written");
  }

 private:
  std::string path_;
  lcm::LogFile file_;
  std::vector<std::uint8_t> buffer_;
};

/// The message that marks the start of trial `number`.
inline component_event_t trial_event(int number, const std::string& name) {
  component_event_t mark{};
  bus::put_text(mark.slot, "collect");
  bus::put_text(mark.event, "trial");
  bus::put_text(mark.reason, name);
  mark.command_counter = number;
  return mark;
}

}  // namespace palpate::log
