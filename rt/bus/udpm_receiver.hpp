#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/udpm_socket.hpp"

namespace palpate::bus {

/// Delivers LCM datagrams from the network to subscriptions. Accepts only short messages of
/// subscribed channels with the exact size and fingerprint; everything else is counted and dropped.
/// No datagram can cause an allocation, an exception, or a read outside the received data.
class UdpmReceiver {
 public:
  explicit UdpmReceiver(DatagramCounters& counters) : counters_(counters) {}
  ~UdpmReceiver() { stop(); }
  UdpmReceiver(const UdpmReceiver&) = delete;
  UdpmReceiver& operator=(const UdpmReceiver&) = delete;

  /// Call before start().
  Subscription& subscribe(const std::string& channel, int encoded_size, std::int64_t fingerprint,
                          int depth);

  /// Joins the group; the caller's thread receives. Throws std::runtime_error with the remedy.
  void open(const UdpmUrl& url);
  /// Delivers all available datagrams, after waiting at most `timeout_ns` for the first one. False
  /// if there was none or the receiver is not open.
  bool receive(std::int64_t timeout_ns) noexcept;

  /// SCHED_FIFO priority of the thread, if granted; 0: ordinary. Call before start().
  void set_priority(int fifo_priority) noexcept { fifo_priority_ = fifo_priority; }
  /// Joins the group and starts the receiver's thread. Throws as open() does.
  void start(const UdpmUrl& url);
  void stop() noexcept;
  bool started() const noexcept { return socket_.is_open(); }
  /// Size of the socket's receive buffer granted by the system, bytes, as in the URL; 0 before
  /// start().
  int receive_buffer_size() const noexcept { return socket_.receive_buffer_size(); }

  /// Processes one datagram of `size` bytes; called by the thread.
  void handle(const std::uint8_t* data, int size, std::int64_t arrival_ns) noexcept;

 private:
  void receive_until_stopped() noexcept;
  bool receive_all() noexcept;
  bool receive_one() noexcept;
  void rest_if_flooded() noexcept;

  DatagramCounters& counters_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  UdpmSocket socket_;
  int wake_ = -1;  // event that ends the thread
  int fifo_priority_ = 0;
  std::int64_t busy_since_ns_ = 0;  // start of continuous reception
  std::int64_t arrival_ns_ = 0;     // arrival of the last datagram
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace palpate::bus
