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

/// The secret that those who command and those who obey share.
using Key = std::array<std::uint8_t, kKeySize>;

/// A key of 32 raw bytes or 64 hexadecimal digits. Throws std::runtime_error, naming file and
/// remedy, where it is absent, of another size, or anybody but its owner has access to it.
Key read_key_file(const std::string& path);

/// Writes a new random key as hexadecimal digits, for its owner's eyes only. Throws
/// std::runtime_error where the file exists already or cannot be written.
void make_key_file(const std::string& path);

/// us since the epoch, CLOCK_REALTIME.
std::int64_t wall_clock_us() noexcept;

/// HMAC-SHA-512-256 (libsodium's crypto_auth) over the channel's name, a zero byte and `data`.
void compute_code(const Key& key, std::string_view channel, const void* data, int size,
                  std::uint8_t* code) noexcept;
/// In a time that tells nothing of where they differ.
bool same_code(const std::uint8_t* a, const std::uint8_t* b) noexcept;

/// Fills `authentication` with the code of everything else in the message and of the channel. For
/// the types of lcmtypes/ that have the field; neither allocates nor throws.
template <class Message>
void seal(const Key& key, std::string_view channel, Message& message) noexcept {
  static_assert(std::is_trivially_copyable_v<Message>, "a type of fixed size");
  static_assert(sizeof(message.authentication) == kCodeSize);
  std::memset(message.authentication, 0, kCodeSize);
  // A structure is at least as long as its fields one after the other; a fingerprint comes first.
  std::uint8_t encoded[sizeof(Message) + sizeof(std::int64_t)];
  const int size = message.encode(encoded, 0, sizeof(encoded));
  compute_code(key, channel, encoded, size, message.authentication);
}

/// Whether somebody who knows the key sealed this message for this channel.
template <class Message>
bool verify(const Key& key, std::string_view channel, const Message& message) noexcept {
  Message expected = message;
  seal(key, channel, expected);
  return same_code(expected.authentication, message.authentication);
}

/// Who may command, as a program is configured. Counters are wall-clock microseconds that never
/// stand still, so that they count up over sessions; a receiver refuses what was sent before it
/// started. Clocks that differ by d between two machines delay the first command by up to d.
struct Access {
  std::optional<Key> key;     // none: everybody
  std::int64_t start_us = 0;  // wall clock; 0 in deterministic runs, whose counters begin at 1
};

/// Counts and, where there is a key, seals the messages of one outgoing channel.
class Sealer {
 public:
  Sealer(std::string channel, const Access& access)
      : channel_(std::move(channel)), access_(access) {}

  /// After everything else in the message is as it will be sent. `now_us`: wall clock.
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
  kRepeated,  // the last one once more: not to be carried out, no reason for alarm
  kRefused
};

/// Decides which messages of one incoming channel may be obeyed: those with a valid code and a
/// counter above every one before. Without a key all are fresh. Ask before anything else looks at a
/// message.
class Admission {
 public:
  Admission(std::string channel, const Access& access)
      : channel_(std::move(channel)),
        key_(access.key),
        start_(access.start_us),
        counter_(access.start_us) {}

  /// From now on refuses what was sent before `start_us`, wall clock.
  void begin(std::int64_t start_us) noexcept {
    if (start_us > counter_) start_ = counter_ = start_us;
  }

  template <class Message>
  Admitted judge(const Message& message) noexcept {
    if (!key_) return Admitted::kFresh;
    before_start_ = -1;
    if (!verify(*key_, channel_, message)) return refuse("no valid authentication code");
    if (any_ && message.counter == counter_) return Admitted::kRepeated;
    if (message.counter <= start_) {
      before_start_ = message.counter;
      return refuse("sent before this program started");
    }
    if (message.counter <= counter_) return refuse("counter of an older message");
    counter_ = message.counter;
    any_ = true;
    return Admitted::kFresh;
  }

  const std::string& channel() const noexcept { return channel_; }
  std::int64_t refused() const noexcept { return refused_; }
  const char* reason() const noexcept { return reason_; }  // of the last refusal
  /// Counter of the last refused message where it was sent before the start: it was surely not
  /// obeyed, so that whoever sent it may send it with a new counter. -1 for any other.
  std::int64_t before_start() const noexcept { return before_start_; }

 private:
  Admitted refuse(const char* reason) noexcept {
    ++refused_;
    reason_ = reason;
    return Admitted::kRefused;
  }

  std::string channel_;
  std::optional<Key> key_;
  std::int64_t start_;  // counters up to here are of before the start
  std::int64_t counter_;
  std::int64_t before_start_ = -1;
  bool any_ = false;  // the counter is that of a message
  std::int64_t refused_ = 0;
  const char* reason_ = "";
};

}  // namespace palpate::bus
