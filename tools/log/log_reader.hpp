#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <palpate/component_event_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/discrepancy_t.hpp>
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
#include "rt/bus/shape_chunks.hpp"

namespace palpate::log {

/// Clock of a log's messages.
enum class LogClock {
  kReceived,  // time of reception by the log: independent of the senders' clocks
  kSent       // the sender's time: in lock-step, where all use the simulator's clock
};

/// Reads an LCM log once and passes each message to the handler of its channel. Messages of
/// unexpected type or length are counted and skipped, those of former types converted. utime is
/// converted to the selected clock (us).
class LogReader {
 public:
  explicit LogReader(LogClock clock = LogClock::kReceived) : clock_(clock) {}

  /// Of messages that follow each other within `least_period` (us) the first is kept.
  template <class Message>
  void collect(const std::string& channel, std::vector<Message>& into,
               std::int64_t least_period = 0) {
    handlers_[channel] = [&into, least_period, clock = clock_](const bus::LoggedEvent& event) {
      Message message;
      if (!bus::decode(message, event.data, event.size)) return false;
      if (clock == LogClock::kReceived) message.utime = event.utime;
      if (is_due(into, message, least_period)) into.push_back(std::move(message));
      return true;
    };
  }
  /// Whole shapes, joined from their chunks.
  void collect(const std::string& channel, std::vector<shape_t>& into,
               std::int64_t least_period = 0);

  /// Reports damaged parts of the file on stderr, and continues after them. Throws
  /// std::runtime_error if the file cannot be read or is not a log.
  void read(const std::filesystem::path& log);

  long events() const { return events_; }
  long undecodable() const { return undecodable_; }

 private:
  template <class Message>
  static bool is_due(const std::vector<Message>& kept, const Message& next,
                     std::int64_t least_period) {
    return least_period <= 0 || kept.empty() || next.utime >= kept.back().utime + least_period;
  }

  std::map<std::string, std::function<bool(const bus::LoggedEvent&)>> handlers_;
  LogClock clock_;
  long events_ = 0;
  long undecodable_ = 0;
};

/// The data of one run required for scoring, ordered by the selected clock.
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
  std::vector<unknown_contact_t> unknown_contacts;  // while detected, and the end of each
  std::vector<discrepancy_t> discrepancies;         // each test of the wrenches
  std::vector<shape_target_t> targets;
  std::vector<robot_state_t> robot;
  std::vector<contacts_t> contacts;
  std::vector<shape_observation_t> observations;
};

/// The last of time-ordered messages that is not after `utime`; nullptr if there is none.
template <class Message>
const Message* latest(const std::vector<Message>& messages, std::int64_t utime) {
  const auto after = std::upper_bound(
      messages.begin(), messages.end(), utime,
      [](std::int64_t time, const Message& message) { return time < message.utime; });
  return after == messages.begin() ? nullptr : &*(after - 1);
}

/// With the senders' clock a target, whose sender does not run in lock-step, counts from the first
/// FEATURE that follows it. `least_period`: us, between messages of the loop's rate and shapes that
/// are kept.
RunLog read_run(const std::filesystem::path& control, const std::filesystem::path& housekeeping,
                LogClock clock = LogClock::kReceived, std::int64_t least_period = 0);

}  // namespace palpate::log
