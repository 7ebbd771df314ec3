#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "rt/bus/udpm_url.hpp"

namespace palpate::inject {

/// Sends datagrams to a multicast group as any host on the network could: no LCM, no checks. At
/// most `rate` of them per second, in bursts of at most a millisecond's worth.
class Sender {
 public:
  /// `rate` 0: as fast as the system accepts them. Throws std::runtime_error with the remedy.
  Sender(const bus::UdpmUrl& url, double rate);
  ~Sender();
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  /// Waits until the datagram is due. The system may refuse it, which is counted.
  void send(const std::vector<std::uint8_t>& datagram);
  /// Sends what is still queued.
  void flush();

  std::int64_t sent() const noexcept { return sent_; }
  std::int64_t refused() const noexcept { return refused_; }
  /// s since the first datagram.
  double elapsed() const;

 private:
  using Clock = std::chrono::steady_clock;
  int socket_ = -1;
  sockaddr_in address_;
  double rate_;
  std::size_t burst_;
  std::vector<std::vector<std::uint8_t>> waiting_;
  std::size_t waiting_count_ = 0;
  std::int64_t sent_ = 0;
  std::int64_t refused_ = 0;
  Clock::time_point began_{};
};

}  // namespace palpate::inject
