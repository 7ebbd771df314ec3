#pragma once

#include <cstdint>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/udpm_url.hpp"

namespace palpate::bus {

/// Hears the datagrams of one LCM URL, without waiting. No datagram can make it allocate or throw.
class UdpmSocket {
 public:
  UdpmSocket() = default;
  ~UdpmSocket() { close(); }
  UdpmSocket(const UdpmSocket&) = delete;
  UdpmSocket& operator=(const UdpmSocket&) = delete;

  /// Joins the group. Throws std::runtime_error with the remedy, and is closed, where that fails.
  void open(const UdpmUrl& url);
  void close() noexcept;
  bool is_open() const noexcept { return descriptor_ >= 0; }

  /// Takes the next datagram to data(), and counts those that the kernel dropped. Its size in
  /// bytes; -1 where none waits.
  int receive(DatagramCounters& counters) noexcept;
  const std::uint8_t* data() const noexcept { return buffer_.data(); }

  /// To poll for.
  int descriptor() const noexcept { return descriptor_; }
  /// Bytes that the system gave the socket for its queue, as the URL counts them; 0 before open().
  int receive_buffer_size() const noexcept { return receive_buffer_size_; }

 private:
  void join(const UdpmUrl& url);

  int descriptor_ = -1;
  int receive_buffer_size_ = 0;
  std::uint32_t overflows_seen_ = 0;  // the kernel's running number
  std::vector<std::uint8_t> buffer_;
};

}  // namespace palpate::bus
