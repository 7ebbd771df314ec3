#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace palpate::bus {

inline constexpr int kKeySize = 32;
inline constexpr int kCodeSize = 32;

/// Secret key shared by the senders and receivers of commands.
using Key = std::array<std::uint8_t, kKeySize>;

/// Reads a key of 32 raw bytes or 64 hexadecimal digits. Throws std::runtime_error, naming file and
/// remedy, if it is missing, has a different size, or is accessible by anyone but its owner.
Key read_key_file(const std::string& path);

/// Writes a new random key as hexadecimal digits, readable by its owner only. Throws
/// std::runtime_error if the file exists or cannot be written.
void make_key_file(const std::string& path);

/// us since the epoch, CLOCK_REALTIME.
std::int64_t wall_clock_us() noexcept;

/// HMAC-SHA-512-256 (libsodium's crypto_auth) over the channel name, a zero byte and `data`.
void compute_code(const Key& key, std::string_view channel, const void* data, int size,
                  std::uint8_t* code) noexcept;
/// Constant-time comparison.
bool same_code(const std::uint8_t* a, const std::uint8_t* b) noexcept;

/// Sets `authentication` to the code of the channel and all other fields of the message. For the
/// types of lcmtypes/ with that field; neither allocates nor throws.
template <class Message>
void seal(const Key& key, std::string_view channel, Message& message) noexcept {
  static_assert(std::is_trivially_copyable_v<Message>, "a type of fixed size");
  static_assert(sizeof(message.authentication) == kCodeSize);
  std::memset(message.authentication, 0, kCodeSize);
  // The structure is at least as long as its encoded fields, which the fingerprint precedes.
  std::uint8_t encoded[sizeof(Message) + sizeof(std::int64_t)];
  const int size = message.encode(encoded, 0, sizeof(encoded));
  compute_code(key, channel, encoded, size, message.authentication);
}

/// True if this message was signed for this channel with the key.
template <class Message>
bool verify(const Key& key, std::string_view channel, const Message& message) noexcept {
  Message expected = message;
  seal(key, channel, expected);
  return same_code(expected.authentication, message.authentication);
}

/// Access control of a program as configured. Counters are strictly increasing wall-clock
/// microseconds, so that they increase across sessions; a receiver rejects messages sent before it
/// started. A clock difference d between two machines delays the first command by up to d.
struct Access {
  std::optional<Key> key;     // empty: commands are accepted without authentication
  std::int64_t start_us = 0;  // wall clock; 0 in deterministic runs, whose counters begin at 1
};

/// Sets the counter and, with a key, the authentication code of the messages of one outgoing
/// channel.
class MessageSigner {
 public:
  MessageSigner(std::string channel, const Access& access)
      : channel_(std::move(channel)), access_(access) {}

  /// Call after all other fields have their final values. `now_us`: wall clock.
  template <class Message>
  void put(Message& message, std::int64_t now_us) noexcept {
    ++counter_;
    if (access_.start_us != 0 && now_us > counter_) counter_ = now_us;
    message.counter = counter_;
    if (access_.key) seal(*access_.key, channel_, message);
  }

 private:
  std::string channel_;
  Access access_;
  std::int64_t counter_ = 0;
};

enum class Admitted {
  kFresh,
  kRepeated,  // the last accepted message again: not executed, and not suspicious
  kRejected
};

/// Replay guard: accepts messages of one incoming channel with a valid code and a counter above all
/// previous ones. Without a key all messages are fresh. Must be checked before any other use of a
/// message.
class ReplayGuard {
 public:
  ReplayGuard(std::string channel, const Access& access)
      : channel_(std::move(channel)),
        key_(access.key),
        start_(access.start_us),
        counter_(access.start_us) {}

  /// Rejects messages sent before `start_us`, wall clock, from now on.
  void begin(std::int64_t start_us) noexcept {
    if (start_us > counter_) start_ = counter_ = start_us;
  }

  template <class Message>
  Admitted judge(const Message& message) noexcept {
    if (!key_) return Admitted::kFresh;
    before_start_ = -1;
    if (!verify(*key_, channel_, message)) return reject("no valid authentication code");
    if (any_ && message.counter == counter_) return Admitted::kRepeated;
    if (message.counter <= start_) {
      before_start_ = message.counter;
      return reject("sent before this program started");
    }
    if (message.counter <= counter_) return reject("counter of an older message");
    counter_ = message.counter;
    any_ = true;
    return Admitted::kFresh;
  }

  const std::string& channel() const noexcept { return channel_; }
  std::int64_t rejected() const noexcept { return rejected_; }
  const char* reason() const noexcept { return reason_; }  // reason of the last rejection
  /// Counter of the last rejected message if it was sent before the start: it was certainly not
  /// executed, so that its sender may repeat it with a new counter. -1 for any other rejection.
  std::int64_t before_start() const noexcept { return before_start_; }

 private:
  Admitted reject(const char* reason) noexcept {
    ++rejected_;
    reason_ = reason;
    return Admitted::kRejected;
  }

  std::string channel_;
  std::optional<Key> key_;
  std::int64_t start_;  // counters up to this one are from before the start
  std::int64_t counter_;
  std::int64_t before_start_ = -1;
  bool any_ = false;  // the counter belongs to a received message
  std::int64_t rejected_ = 0;
  const char* reason_ = "";
};

}  // namespace palpate::bus
