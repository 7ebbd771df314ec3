#pragma once

#include <array>
#include <cstdint>
#include <drake/lcmt_force_torque.hpp>
#include <string>
#include <utility>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "tools/bridge/common/protocol.hpp"

// Drake's messages have arrays of as many numbers as the arm has joints. For one arm their size is
// thus fixed, and the bus checks it before a message is decoded.

namespace palpate::drake_bridge {

using bridge::Joints;
using bridge::Protocol;
using bridge::Reading;

/// Big-endian number in an encoded message.
template <class Number>
Number number_at(const void* data, int offset) noexcept {
  std::uint64_t value = 0;
  const auto* bytes = static_cast<const std::uint8_t*>(data) + offset;
  for (std::size_t i = 0; i < sizeof(Number); ++i) value = value << 8 | bytes[i];
  return static_cast<Number>(value);
}

inline constexpr int kUtimeOffset = 8;    // after the fingerprint: the first field of every type
inline constexpr int kJointsOffset = 16;  // of a status: the only count

/// Statuses of an arm, of a type that begins with utime and num_joints and has no other count.
template <class Message>
class StatusInput {
 public:
  static constexpr int kDepth = 16;

  /// `model`: a message with arrays of the arm's length. Throws as subscribe() does.
  StatusInput(bus::MessageBus& bus, const std::string& channel, Message model)
      : message_(std::move(model)),
        raw_(&bus.subscribe(channel, message_.getEncodedSize(), Message::getHash(), kDepth)) {}

  /// The next message, valid until the next call; nullptr if there is none.
  const Message* take(std::int64_t& arrival_ns) {
    while (const void* data = raw_->take(arrival_ns)) {
      // Generated code would allocate as much as a forged count announces.
      if (number_at<std::int32_t>(data, kJointsOffset) != message_.num_joints) continue;
      if (message_.decode(data, 0, raw_->encoded_size()) > 0) return &message_;
    }
    return nullptr;
  }
  const bus::Subscription& subscription() const { return *raw_; }

 private:
  Message message_;
  bus::Subscription* raw_;
};

/// Messages on a status channel that are refused because of type or size, in words.
class Refusals {
 public:
  /// `inputs`: all accepted types of the channel. `accepted`: what these are.
  Refusals(std::vector<const bus::Subscription*> inputs, std::string accepted)
      : inputs_(std::move(inputs)), accepted_(std::move(accepted)) {}

  /// Once for each type, and once for a wrong size; empty if there is nothing new.
  std::string next();

 private:
  std::vector<const bus::Subscription*> inputs_;
  std::string accepted_;
  std::int64_t reported_type_ = 0;
  bool reported_size_ = false;
};

/// Recognises messages that another program publishes on a channel of commands: all messages with
/// utime first, other than those with a time that this program has used.
class CommandWatch {
 public:
  CommandWatch(bus::MessageBus& bus, const std::string& channel, int encoded_size,
               std::int64_t fingerprint)
      : raw_(&bus.subscribe(channel, encoded_size, fingerprint, kRemembered)) {}

  /// A time for the next own command: `utime`, or later if that has been used.
  std::int64_t stamp(std::int64_t utime) noexcept;
  /// Whether a foreign message has arrived since the last call.
  bool any() noexcept;

 private:
  static constexpr int kRemembered = 256;

  bus::Subscription* raw_;
  std::array<std::int64_t, kRemembered> sent_{};
  std::int64_t last_ = 0;
  int next_ = 0;
  std::int64_t refused_ = 0;  // of another type or size: not our own
};

/// Commands to an arm, and those of others on the same channel.
template <class Message>
class CommandOutput {
 public:
  /// `model`: a command as this program sends it.
  CommandOutput(bus::MessageBus& bus, const std::string& channel, Message model)
      : message_(std::move(model)),
        publisher_(bus, channel),
        watch_(bus, channel, message_.getEncodedSize(), Message::getHash()) {}

  Message& message() { return message_; }
  void publish(std::int64_t utime) {
    message_.utime = watch_.stamp(utime);
    publisher_.publish(message_);
  }
  bool any_foreign() noexcept { return watch_.any(); }

 private:
  Message message_;
  bus::TypedPublisher<Message> publisher_;
  CommandWatch watch_;
};

/// Messages of a wrist sensor, lcmt_force_torque in S.
class ForceTorqueInput final : public bridge::WrenchInput {
 public:
  ForceTorqueInput(bus::MessageBus& bus, const std::string& channel)
      : messages_(bus, channel, 64) {}

  bool take(math::Wrench& wrench_S) override;

 private:
  bus::TypedSubscription<::drake::lcmt_force_torque> messages_;
};

}  // namespace palpate::drake_bridge
