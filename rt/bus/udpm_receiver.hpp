#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/udpm_socket.hpp"

namespace palpate::bus {

/// Takes LCM datagrams from the network to subscriptions. Only short messages of subscribed
/// channels with the exact size and fingerprint get through; all else is counted and forgotten. No
/// datagram can make it allocate, throw, or read outside what was received.
class UdpmReceiver {
 public:
  explicit UdpmReceiver(DatagramCounters& counters) : counters_(counters) {}
  ~UdpmReceiver() { stop(); }
  UdpmReceiver(const UdpmReceiver&) = delete;
  UdpmReceiver& operator=(const UdpmReceiver&) = delete;

  /// Before start().
  Subscription& subscribe(const std::string& channel, int encoded_size, std::int64_t fingerprint,
                          int depth);

  /// Joins the group; the caller receives. Throws std::runtime_error with the remedy.
  void open(const UdpmUrl& url);
  /// Hands on all that has come, after waiting at most `timeout_ns` for something. False where
  /// nothing came or it is not open.
  bool receive(std::int64_t timeout_ns) noexcept;

  /// SCHED_FIFO for the thread, where it is granted; 0: ordinary. Before start().
  void set_priority(int fifo_priority) noexcept { fifo_priority_ = fifo_priority; }
  /// Joins the group and starts the receiver's thread. Throws as open() does.
  void start(const UdpmUrl& url);
  void stop() noexcept;
  bool started() const noexcept { return socket_.is_open(); }
  /// Bytes that the system gave the socket for its queue, as the URL counts them; 0 before start().
  int receive_buffer_size() const noexcept { return socket_.receive_buffer_size(); }

  /// One datagram of `size` bytes, as the thread calls it.
  void handle(const std::uint8_t* data, int size, std::int64_t arrival_ns) noexcept;

 private:
  void receive_until_stopped() noexcept;
  bool receive_all() noexcept;
  bool receive_one() noexcept;
  void rest_if_flooded() noexcept;

  DatagramCounters& counters_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  UdpmSocket socket_;
  int wake_ = -1;  // the event that ends the thread
  int fifo_priority_ = 0;
  std::int64_t busy_since_ns_ = 0;  // without a pause
  std::int64_t arrival_ns_ = 0;     // of the last datagram
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace palpate::bus
