#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::bus {

/// Publishes the messages of one channel with their header.
template <class Message>
class StampedPublisher {
 public:
  StampedPublisher(MessageBus& bus, std::string channel, std::int64_t session,
                   Urgency urgency = Urgency::kNow)
      : publisher_(bus, std::move(channel), urgency), stamp_(session) {}

  /// Sets utime (us), seq and session; for the rest see TypedPublisher.
  bool publish(Message& message, std::int64_t utime) noexcept {
    stamp_.put(message, utime);
    return publisher_.publish(message);
  }

 private:
  TypedPublisher<Message> publisher_;
  HeaderStamper stamp_;
};

}  // namespace palpate::bus
