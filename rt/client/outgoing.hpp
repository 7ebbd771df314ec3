#pragma once

#include <cstdint>
#include <string>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::client {

/// Messages of one channel to the daemon: stamped, counted and, with a key, signed.
template <class Message>
class Outgoing {
 public:
  Outgoing(bus::MessageBus& bus, const std::string& channel, const bus::Access& access,
           std::int64_t session)
      : publisher_(bus, channel), signer_(channel, access), stamper_(session) {}
  /// Call after all other fields have their final values. `now_us`: wall clock.
  void sign(Message& message, std::int64_t now_us) {
    stamper_.put(message, now_us);
    signer_.put(message, now_us);
  }
  void publish(const Message& message) { publisher_.publish(message); }

 private:
  bus::TypedPublisher<Message> publisher_;
  bus::MessageSigner signer_;
  bus::HeaderStamper stamper_;
};

}  // namespace palpate::client
