#pragma once

#include <cstdint>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/udpm_url.hpp"

namespace palpate::bus {

/// Non-blocking receiver of the datagrams of one LCM URL. No datagram can cause an allocation or an
/// exception.
class UdpmSocket {
 public:
  UdpmSocket() = default;
  ~UdpmSocket() { close(); }
  UdpmSocket(const UdpmSocket&) = delete;
  UdpmSocket& operator=(const UdpmSocket&) = delete;

  /// Joins the group. Throws std::runtime_error with the remedy and closes the socket on failure.
  void open(const UdpmUrl& url);
  void close() noexcept;
  bool is_open() const noexcept { return descriptor_ >= 0; }

  /// Reads the next datagram into data(), and counts those that the kernel dropped. Returns its
  /// size in bytes; -1 if there is none.
  int receive(DatagramCounters& counters) noexcept;
  const std::uint8_t* data() const noexcept { return buffer_.data(); }

  /// for poll()
  int descriptor() const noexcept { return descriptor_; }
  /// Size of the socket's receive buffer granted by the system, bytes, as in the URL; 0 before
  /// open().
  int receive_buffer_size() const noexcept { return receive_buffer_size_; }

 private:
  void join(const UdpmUrl& url);

  int descriptor_ = -1;
  int receive_buffer_size_ = 0;
  std::uint32_t overflows_seen_ = 0;  // last value of the kernel's drop counter
  std::vector<std::uint8_t> buffer_;
};

}  // namespace palpate::bus
