#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::bus {

inline constexpr int kLongestChannel = 63;
/// Maximum size of name, terminating zero and payload of a message: the largest UDP payload without
/// LCM's header of 8 bytes.
inline constexpr int kLargestShortMessage = 65507 - 8;
/// Of a message that a subscription takes, bytes with its fingerprint.
inline constexpr int kLargestEncodedSize = 65000;

/// True for 1 to 63 of the characters A-Z, 0-9 and _.
bool is_channel_name(const std::string& name) noexcept;

/// Names on a bus of channels that have another one there than palpate's own, by their own.
using ChannelNames = std::map<std::string, std::string>;
/// Palpate's own name of the channel that is `name` on a bus; "" for a channel that only has the
/// own name of a renamed one.
std::string_view own_name(const ChannelNames& names, std::string_view name) noexcept;

/// True if a message of `size` bytes fits into one datagram and the name has 1 to 63 characters.
bool fits_one_datagram(const char* channel, int size) noexcept;

/// Counters of one subscription; written by the receiver, readable by any thread.
struct SubscriptionCounters {
  std::atomic<std::int64_t> received{0};  // accepted into the queue
  std::atomic<std::int64_t> dropped{0};   // queue full: the oldest message was dropped
  std::atomic<std::int64_t> wrong_size{0};
  std::atomic<std::int64_t> wrong_type{0};  // fingerprint of another type or version
  std::atomic<std::int64_t> last_wrong_fingerprint{0};
  std::atomic<std::int64_t> other_sender{0};  // from a publisher other than the accepted one
};

/// Counters of whole datagrams at the receiver, before any subscription; zero on a bus without
/// datagrams.
struct DatagramCounters {
  std::atomic<std::int64_t> received{0};
  std::atomic<std::int64_t> malformed{0};  // not an LCM message: framing, channel name or size
  /// Fragment of a larger message, where those are not received; else one that was dropped.
  std::atomic<std::int64_t> fragmented{0};
  std::atomic<std::int64_t> unsubscribed{0};  // channel without a subscription
  std::atomic<std::int64_t> overflowed{0};    // lost because the socket buffer was full
};

/// Bounded lock-free queue of encoded messages of one channel and one fixed size, from the
/// receiver's thread to one consumer. Messages of another size or fingerprint are rejected.
class Subscription {
 public:
  /// encoded_size includes the 8 bytes of the fingerprint. Throws std::invalid_argument for a name
  /// other than [A-Z0-9_]+ of at most 63 characters, a size below 8 or above 65000, or a depth
  /// below 1.
  Subscription(std::string channel, int encoded_size, std::int64_t fingerprint, int depth);
  ~Subscription();

  /// Call before the bus starts. Locks the subscription to the first of several publishers,
  /// identified by the session of their messages, until it has been silent for `silence_ns`; if it
  /// resumes within five times that, it is accepted again. Messages of other publishers, however
  /// many, do not enter the queue.
  void lock_to_first_publisher(std::int64_t silence_ns) noexcept { silence_ns_ = silence_ns; }

  /// Called by the receiver. `arrival_ns`: CLOCK_MONOTONIC (or virtual time).
  void offer(const void* data, int size, std::int64_t arrival_ns) noexcept;

  /// Called by the consumer: the oldest message, encoded_size() bytes, valid until the next call;
  /// nullptr if the queue is empty.
  const void* take(std::int64_t& arrival_ns) noexcept;

  const std::string& channel() const noexcept { return channel_; }
  int encoded_size() const noexcept { return encoded_size_; }
  std::int64_t fingerprint() const noexcept { return fingerprint_; }
  const SubscriptionCounters& counters() const noexcept { return counters_; }

 private:
  bool is_followed(const void* data, std::int64_t arrival_ns) noexcept;

  std::string channel_;
  int encoded_size_;
  std::int64_t fingerprint_;
  struct Sender {
    std::int64_t session = 0;
    std::int64_t received_ns = 0;  // arrival of its last message
    bool any = false;
  };
  std::int64_t silence_ns_ = -1;  // negative: all publishers are accepted
  Sender followed_, before_;
  SubscriptionCounters counters_;
  struct Queue;
  std::unique_ptr<Queue> queue_;
};

/// Observer of messages, called in the thread that takes or publishes them.
class MessageTap {
 public:
  /// `data`: encoded message with its fingerprint.
  virtual void note(const std::string& channel, const void* data, int size) noexcept = 0;

 protected:
  ~MessageTap() = default;
};

/// Queue from the loop to a bus's own publishing thread; used by one thread at a time. Neither
/// allocates nor waits.
class Outlet {
 public:
  /// Where the next message is to be encoded; nullptr, counted as lost, if `size` is too large.
  virtual std::uint8_t* buffer(int size) noexcept = 0;
  /// Hands over the `size` bytes in buffer(). False, counted as lost, for an invalid channel name.
  virtual bool commit(const char* channel, int size) noexcept = 0;

 protected:
  ~Outlet() = default;
};

/// Message transport. Set-up: subscribe, then start. publish() neither allocates nor throws and may
/// be called by one thread at a time.
class MessageBus {
 public:
  virtual ~MessageBus() = default;
  /// Call before start(). The bus owns the subscription.
  virtual Subscription& subscribe(const std::string& channel, int encoded_size,
                                  std::int64_t fingerprint, int depth) = 0;
  /// Call before start(): SCHED_FIFO priority of the receiver's thread, if the system grants it, so
  /// that inputs are not delayed on a loaded machine; 0 (default): ordinary scheduling.
  virtual void set_receiver_priority(int) noexcept {}
  /// Starts the receiver's thread, if there is one; throws std::runtime_error.
  virtual void start() = 0;
  /// Alternative to start() for a program that waits for messages: the thread that calls receive()
  /// also receives, which saves waking another one. Throws as start() does.
  virtual void start_without_thread() = 0;
  /// After start_without_thread(): delivers all available messages to the subscriptions, after
  /// waiting at most `timeout_ns` for the first one. False if there was none; returns false at once
  /// on a bus that delivers synchronously.
  virtual bool receive(std::int64_t timeout_ns) noexcept = 0;
  virtual void stop() noexcept = 0;
  /// False if the message does not fit into one datagram or the system rejects it.
  virtual bool publish(const char* channel, const void* data, int size) noexcept = 0;
  /// Set-up: messages that are not required within the cycle are published by a thread of the bus
  /// from now on, through outlet(), with a queue of `depth` messages of at most `largest` encoded
  /// bytes. No effect on a bus that delivers synchronously.
  virtual void start_publisher(int /*depth*/, int /*largest*/) {}
  /// Queue of start_publisher(); nullptr without its thread.
  virtual Outlet* outlet() noexcept { return nullptr; }
  /// Number of messages passed to outlet() that were not sent.
  virtual std::int64_t unpublished() const noexcept { return 0; }
  const DatagramCounters& datagrams() const noexcept { return datagrams_; }
  /// In order of subscription.
  const std::vector<const Subscription*>& subscriptions() const noexcept { return listed_; }

  /// Call before anything subscribes or publishes: typed subscriptions and publishers of this bus
  /// take their channels by palpate's names and use these. Subscriptions, taps and counters refer
  /// to the names on the bus.
  void set_channel_names(ChannelNames names) { names_ = std::move(names); }
  const std::string& name_of(const std::string& channel) const {
    const auto found = names_.find(channel);
    return found == names_.end() ? channel : found->second;
  }

  /// Sets the observer of all messages that typed subscriptions and publishers of this bus take and
  /// publish; nullptr: none.
  void set_tap(MessageTap* tap) noexcept { tap_ = tap; }
  MessageTap* tap() const noexcept { return tap_; }

 protected:
  Subscription& listed(Subscription& subscription) {
    listed_.push_back(&subscription);
    return subscription;
  }
  DatagramCounters datagrams_;

 private:
  std::vector<const Subscription*> listed_;
  MessageTap* tap_ = nullptr;
  ChannelNames names_;
};

/// LCM UDP multicast, udpm://ADDRESS:PORT?ttl=N&recv_buf_size=BYTES. Publishes through liblcm;
/// reception is implemented here, because a single malformed packet terminates a process that
/// receives through liblcm: only short messages of subscribed channels are accepted, and size and
/// fingerprint are checked before decoding. Throws std::invalid_argument for an invalid URL, and
/// std::runtime_error with the remedy if it cannot be opened.
std::unique_ptr<MessageBus> make_lcm_bus(const std::string& url);

/// In-process bus for tests and stepped runs: publish() delivers synchronously to every
/// subscription of the channel, with the time of `clock_ns` as arrival. Several participants attach
/// to one hub.
class MemoryHub;
std::shared_ptr<MemoryHub> make_memory_hub();
std::unique_ptr<MessageBus> make_memory_bus(std::shared_ptr<MemoryHub> hub);
/// Sets the virtual time at which messages arrive.
void set_time(MemoryHub& hub, std::int64_t now_ns) noexcept;
struct Published {
  std::string channel;
  std::vector<std::uint8_t> data;
  std::int64_t time_ns;
};
/// Stores a copy of each message from now on (allocates; for tests and replay).
void record(MemoryHub& hub, std::vector<Published>* into) noexcept;

/// Typed subscription: T is a type generated by lcm-gen with a fixed size.
template <class T>
class TypedSubscription {
 public:
  TypedSubscription(MessageBus& bus, const std::string& channel, int depth)
      : bus_(&bus),
        raw_(&bus.subscribe(bus.name_of(channel), T().getEncodedSize(), T::getHash(), depth)) {}

  /// False if there is no message. Does not allocate for types of fixed size.
  bool take(T& message, std::int64_t& arrival_ns) noexcept {
    const void* data = raw_->take(arrival_ns);
    if (data == nullptr) return false;
    if (MessageTap* tap = bus_->tap()) tap->note(raw_->channel(), data, raw_->encoded_size());
    return message.decode(data, 0, raw_->encoded_size()) >= 0;
  }
  const SubscriptionCounters& counters() const noexcept { return raw_->counters(); }
  void lock_to_first_publisher(std::int64_t silence_ns) noexcept {
    raw_->lock_to_first_publisher(silence_ns);
  }

 private:
  MessageBus* bus_;
  Subscription* raw_;
};

/// kNow: in the publishing thread; kLater: in the bus's own thread, if it has one.
enum class Urgency { kNow, kLater };

/// Encodes into its own buffer, or with kLater into the bus's queue, and publishes; for types of
/// fixed size nothing allocates after construction. Variable types allocate when they grow.
template <class T>
class TypedPublisher {
 public:
  TypedPublisher(MessageBus& bus, const std::string& channel, Urgency urgency = Urgency::kNow)
      : bus_(&bus),
        channel_(bus.name_of(channel)),
        buffer_(T().getEncodedSize()),
        urgency_(urgency) {}

  /// Reserves capacity for messages of `size` encoded bytes, so that publishing them does not
  /// allocate.
  void reserve(int size) {
    if (size > static_cast<int>(buffer_.size())) buffer_.resize(size);
  }

  bool publish(const T& message) noexcept {
    const int size = message.getEncodedSize();
    return publish_encoded(size, [&](std::uint8_t* to) { message.encode(to, 0, size); });
  }

  /// Same for a message of `size` bytes that `encode(std::uint8_t*)` writes to where it is sent
  /// from; `encode` must be noexcept.
  template <class Encode>
  bool publish_encoded(int size, Encode encode) noexcept {
    Outlet* outlet = urgency_ == Urgency::kLater ? bus_->outlet() : nullptr;
    if (outlet == nullptr && size > static_cast<int>(buffer_.size())) buffer_.resize(size);
    std::uint8_t* data = outlet != nullptr ? outlet->buffer(size) : buffer_.data();
    if (data == nullptr) return false;
    encode(data);
    if (MessageTap* tap = bus_->tap()) tap->note(channel_, data, size);
    return outlet != nullptr ? outlet->commit(channel_.c_str(), size)
                             : bus_->publish(channel_.c_str(), data, size);
  }

 private:
  MessageBus* bus_;
  std::string channel_;
  std::vector<std::uint8_t> buffer_;
  Urgency urgency_;
};

}  // namespace palpate::bus
