#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "messages.hpp"

namespace palpate::ros2_bridge {

/// What the time of a message is, and which messages are too old.
struct Clock {
  bool is_sender = true;  // the stamp, of the system time; false: that of reception, whatever it is
  double most_age = 0.1;  // s, of a stamp at reception, and of one that is ahead
};

/// Admits the messages of one input by their time, and counts.
class Intake {
 public:
  struct Counts {
    std::atomic<std::int64_t> accepted{0};
    std::atomic<std::int64_t> malformed{0};  // wrong size, not finite, no time
    std::atomic<std::int64_t> late{0};
    std::atomic<std::int64_t> ahead{0};      // of this machine's clock
    std::atomic<std::int64_t> overtaken{0};  // not later than one before
  };

  Intake(std::string topic, const Clock& clock) : topic_(std::move(topic)), clock_(clock) {}

  /// The message's time, us; empty if it is refused. `now_us`: system time. A stamp of zero, which
  /// some drivers send, counts as now.
  std::optional<std::int64_t> admit(const Time& stamp, std::int64_t now_us);
  /// For a reason that is a literal.
  void refuse(const char* reason) { refuse(counts_.malformed, reason); }
  /// A new reason why messages are refused, with the topic; empty if there is none.
  std::string complaint();

  const std::string& topic() const { return topic_; }
  const Counts& counts() const { return counts_; }
  /// Numbers of what has been accepted and refused.
  std::string summary() const;

 private:
  void refuse(std::atomic<std::int64_t>& count, const char* reason);

  std::string topic_;
  Clock clock_;
  Counts counts_;
  std::int64_t newest_ = 0;
  std::vector<const char*> reasons_;
  std::size_t said_ = 0;
};

}  // namespace palpate::ros2_bridge
