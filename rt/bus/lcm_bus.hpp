#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/udpm_url.hpp"

// Reception of LCM's UDP multicast, for make_lcm_bus() and for programs that listen to channels of
// any type.

namespace palpate::bus {

inline constexpr int kUdpmHeaderSize = 8;

/// LCM's framing of a short message in one datagram: the magic number "LC02" and a sequence number,
/// 32 bits each in network order, the zero-terminated channel name, and the payload.
struct UdpmFrame {
  std::string_view channel;  // 1 to 63 characters
  const std::uint8_t* payload;
  int payload_size;  // bytes
};

/// Parses untrusted data without reading beyond `size` bytes and without copying: the frame points
/// into `data`. Counts every datagram as received, and those that are no short message as a
/// fragment of a larger one ("LC03") or as malformed: too short, another magic number, or a name
/// that is empty, longer than 63 characters, or not terminated. False for these; the frame is not
/// set.
bool parse_udpm_frame(const std::uint8_t* data, int size, DatagramCounters& counters,
                      UdpmFrame& frame) noexcept;

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
  /// Address and port of the sender of that datagram.
  std::uint64_t sender() const noexcept { return sender_; }

  /// for poll()
  int descriptor() const noexcept { return descriptor_; }
  /// Size of the socket's receive buffer granted by the system, bytes, as in the URL; 0 before
  /// open().
  int receive_buffer_size() const noexcept { return receive_buffer_size_; }

 private:
  void join(const UdpmUrl& url);

  int descriptor_ = -1;
  int receive_buffer_size_ = 0;
  std::uint64_t sender_ = 0;
  std::uint32_t overflows_seen_ = 0;  // last value of the kernel's drop counter
  std::vector<std::uint8_t> buffer_;
};

class FragmentAssembler;

/// Delivers LCM datagrams from the network to subscriptions. Accepts only messages of subscribed
/// channels with the exact size and fingerprint; everything else is counted and dropped. No
/// datagram can cause an allocation, an exception, or a read outside the received data.
class UdpmReceiver {
 public:
  /// `largest`: payload of messages whose fragments are joined, bytes (FragmentAssembler, whose
  /// memory is allocated here); 0: fragments are counted and dropped.
  explicit UdpmReceiver(DatagramCounters& counters, int largest = 0);
  ~UdpmReceiver();
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

  /// Processes one datagram of `size` bytes; called by the thread. `sender`: its address.
  void handle(const std::uint8_t* data, int size, std::int64_t arrival_ns,
              std::uint64_t sender = 0) noexcept;

 private:
  void receive_until_stopped() noexcept;
  bool receive_all() noexcept;
  bool receive_one() noexcept;
  void rest_if_flooded() noexcept;

  DatagramCounters& counters_;
  std::unique_ptr<FragmentAssembler> fragments_;  // nullptr: none are joined
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  UdpmSocket socket_;
  int wake_ = -1;  // event that ends the thread
  int fifo_priority_ = 0;
  std::int64_t busy_since_ns_ = 0;  // start of continuous reception
  std::int64_t arrival_ns_ = 0;     // arrival of the last datagram
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// As make_lcm_bus(url), and messages of several fragments with a payload of up to `largest` bytes
/// are received as well; 0: none. Throws as that does.
std::unique_ptr<MessageBus> make_lcm_bus(const std::string& url, int largest);

}  // namespace palpate::bus
