#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate::bus {

/// Session ID for this start of a program: random and positive. Deterministic runs use a fixed
/// number instead.
std::int64_t random_session();

/// Sets utime, seq and session of the messages of one outgoing channel.
class HeaderStamper {
 public:
  explicit HeaderStamper(std::int64_t session) noexcept : session_(session) {}

  /// `utime`: us, clock of this program.
  template <class Message>
  void put(Message& message, std::int64_t utime) noexcept {
    message.utime = utime;
    message.seq = static_cast<std::int32_t>(++seq_);
    message.session = session_;
  }

 private:
  std::int64_t session_;
  std::uint32_t seq_ = 0;  // wraps after 50 days at 1 kHz; receivers compare modulo 2^32
};

/// Accepts messages of one incoming channel that are newer than all previous ones. Messages of the
/// newest session are valid: an unknown session is accepted at once (restart of the sender), and
/// messages of previous sessions are outdated. If only outdated messages arrive, 20 of one session
/// in ascending order, that session becomes valid (replay of a log).
class SequenceTracker {
 public:
  /// False for a message that is older than the last accepted one, or identical to it.
  bool accept(std::int64_t session, std::int32_t seq) noexcept;

  /// Number of skipped sequence numbers; a late message remains counted here and is rejected.
  std::int64_t lost() const noexcept { return lost_; }
  std::int64_t rejected() const noexcept { return rejected_; }
  /// Number of sessions including the first; above 1 the sender has restarted.
  std::int64_t sessions() const noexcept { return sessions_; }

 private:
  static constexpr int kRestartAfter = 20;
  void begin(std::int64_t session, std::int32_t seq) noexcept;
  bool left_before(std::int64_t session) const noexcept;
  bool old_but_alone(std::int64_t session, std::int32_t seq) noexcept;

  std::int64_t session_ = 0;
  std::int32_t seq_ = 0;
  std::array<std::int64_t, 4> left_{};  // previous sessions, newest first
  std::ptrdiff_t left_count_ = 0;
  std::int64_t old_session_ = 0;
  std::int32_t old_seq_ = 0;
  int old_in_a_row_ = 0;
  std::int64_t lost_ = 0;
  std::int64_t rejected_ = 0;
  std::int64_t sessions_ = 0;
};

}  // namespace palpate::bus
