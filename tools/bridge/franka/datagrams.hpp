#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace palpate::franka_bridge {

/// Datagrams from and to one host. Only wait() waits.
class Datagrams {
 public:
  virtual ~Datagrams() = default;
  /// Where the host has to send them.
  virtual std::uint16_t port() const = 0;
  /// The next one: its whole size, of which up to `size` bytes are stored; -1 if there is none.
  virtual int receive(std::uint8_t* to, int size) = 0;
  /// To where the last one came from; dropped if none has come or the network does not take it.
  virtual void send(const std::uint8_t* data, int size) = 0;
  /// Until one has arrived, at most until `until_ns`, CLOCK_MONOTONIC.
  virtual void wait(std::int64_t until_ns) = 0;
};

/// By UDP. Those of other hosts than `host` are dropped. Throws std::runtime_error if `host` has no
/// address or there is no socket.
std::unique_ptr<Datagrams> make_udp_datagrams(const std::string& host);

}  // namespace palpate::franka_bridge
