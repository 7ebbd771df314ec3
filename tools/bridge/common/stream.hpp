#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <memory>
#include <string>

namespace palpate::bridge {

/// A connection to a server that never waits. All functions return at once.
class Stream {
 public:
  enum class State { kClosed, kConnecting, kOpen };

  virtual ~Stream() = default;
  /// Begins to connect, after close().
  virtual void open() = 0;
  virtual State state() = 0;
  /// Up to `size` bytes that have arrived; their number, 0 if there are none. Closes the stream at
  /// the peer's end and after an error.
  virtual int read(std::uint8_t* to, int size) = 0;
  /// Sends all, now or with later calls. False, and closed, after an error or if the peer has not
  /// taken earlier data.
  virtual bool write(const std::uint8_t* data, int size) = 0;
  virtual void close() = 0;
  /// "host:port".
  virtual const std::string& name() const = 0;
};

/// Throws std::runtime_error if `host`, a name or an address, has none.
sockaddr_in ipv4_address(const std::string& host, int port);

/// By TCP, without delay. Throws std::runtime_error if `host` has no address.
std::unique_ptr<Stream> make_tcp_stream(const std::string& host, int port);

}  // namespace palpate::bridge
