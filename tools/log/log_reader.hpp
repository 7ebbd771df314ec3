#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <palpate/component_event_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/truth_contact_t.hpp>
#include <palpate/truth_touch_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <palpate/unknown_contact_t.hpp>
#include <string>
#include <vector>

#include "rt/bus/checked_decode.hpp"
#include "rt/bus/event_log_reader.hpp"

namespace palpate::log {

/// Which time a message of a log has.
enum class LogClock {
  kReceived,  // when the log received it: the clocks of the senders need not agree
  kSent       // what its sender says: in lock-step, where all follow the simulator's clock
};

/// Reads an LCM log once and hands each message to whom asked for its channel. Messages of another
/// type or length than expected are counted and skipped. utime becomes that of the clock (us).
class LogReader {
 public:
  explicit LogReader(LogClock clock = LogClock::kReceived) : clock_(clock) {}

  template <class Message>
  void collect(const std::string& channel, std::vector<Message>& into) {
    handlers_[channel] = [&into, clock = clock_](const bus::LoggedEvent& event) {
      Message message;
      if (!bus::checked_decode(message, event.data, event.size)) return false;
      if (clock == LogClock::kReceived) message.utime = event.utime;
      into.push_back(std::move(message));
      return true;
    };
  }

  /// Says on stderr what of the file is no event, and goes on behind it. Throws std::runtime_error
  /// where the file cannot be read or is no log.
  void read(const std::filesystem::path& log);

  long events() const { return events_; }
  long undecodable() const { return undecodable_; }

 private:
  std::map<std::string, std::function<bool(const bus::LoggedEvent&)>> handlers_;
  LogClock clock_;
  long events_ = 0;
  long undecodable_ = 0;
};

/// What scoring needs of one run, in the order of the clock that it was read by.
struct RunLog {
  std::vector<shape_t> shapes;  // the estimate
  std::vector<shape_mesh_t> shape_chunks;
  std::vector<shape_t> truths;  // the plant
  std::vector<shape_mesh_t> truth_chunks;
  std::vector<truth_contact_t> truth_contacts;
  std::vector<truth_touch_t> truth_touches;
  std::vector<health_t> health;
  std::vector<component_event_t> events;
  std::vector<twist_command_t> commands;
  std::vector<feature_t> features;
  std::vector<estimate_t> estimates;
  std::vector<unknown_contact_t> unknown_contacts;  // while felt, and where each ends
  std::vector<shape_target_t> targets;
  std::vector<robot_state_t> robot;
  std::vector<contacts_t> contacts;
  std::vector<shape_observation_t> observations;
};

/// The last of messages in the order of their times that is not after `utime`; nullptr where none
/// is.
template <class Message>
const Message* latest(const std::vector<Message>& messages, std::int64_t utime) {
  const auto after = std::upper_bound(
      messages.begin(), messages.end(), utime,
      [](std::int64_t time, const Message& message) { return time < message.utime; });
  return after == messages.begin() ? nullptr : &*(after - 1);
}

/// By the senders' clock a target, whose sender is no part of the lock-step, counts from the first
/// FEATURE that follows it.
RunLog read_run(const std::filesystem::path& control, const std::filesystem::path& housekeeping,
                LogClock clock = LogClock::kReceived);

}  // namespace palpate::log
