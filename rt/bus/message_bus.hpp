#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace palpate::bus {

/// Counters of one subscription, written by the receiver, read by anyone.
struct SubscriptionCounters {
  std::atomic<std::int64_t> received{0};  // accepted into the queue
  std::atomic<std::int64_t> dropped{0};   // the queue was full: the oldest went
  std::atomic<std::int64_t> wrong_size{0};
  std::atomic<std::int64_t> wrong_type{0};  // fingerprint of another type or version
  std::atomic<std::int64_t> last_wrong_fingerprint{0};
  std::atomic<std::int64_t> other_sender{0};  // beside the one that is heard
};

/// What a receiver saw of whole datagrams, before any subscription; zero on a bus without
/// datagrams.
struct DatagramCounters {
  std::atomic<std::int64_t> received{0};
  std::atomic<std::int64_t> malformed{0};     // not an LCM message: framing, channel name, size
  std::atomic<std::int64_t> fragmented{0};    // part of a larger message, which nobody here takes
  std::atomic<std::int64_t> unsubscribed{0};  // of a channel that is not on the list
  std::atomic<std::int64_t> overflowed{0};    // lost because the socket's buffer was full
};

/// A bounded queue of encoded messages of one channel and one fixed size, from the receiver's
/// thread to one consumer, lock-free. Messages of another size or fingerprint never enter it.
class Subscription {
 public:
  /// encoded_size includes the 8 bytes of the fingerprint. Throws std::invalid_argument for a name
  /// that is not [A-Z0-9_]+ of at most 63 characters, a size below 8 or above 65000, or a depth
  /// below 1.
  Subscription(std::string channel, int encoded_size, std::int64_t fingerprint, int depth);
  ~Subscription();

  /// Before the bus starts: of several senders, told apart by the session of their messages, only
  /// one is heard, until nothing has come from it for `silence_ns`; should it go on after all
  /// within five times that, it is heard again. What a stray one sends, however much, takes no
  /// place in the queue.
  void hear_one_sender(std::int64_t silence_ns) noexcept { silence_ns_ = silence_ns; }

  /// Receiver's side. `arrival_ns`: CLOCK_MONOTONIC (or virtual time).
  void offer(const void* data, int size, std::int64_t arrival_ns) noexcept;

  /// Consumer's side: copies the oldest message to `buffer` (encoded_size long). False when empty.
  bool take(void* buffer, std::int64_t& arrival_ns) noexcept;

  const std::string& channel() const noexcept { return channel_; }
  int encoded_size() const noexcept { return encoded_size_; }
  std::int64_t fingerprint() const noexcept { return fingerprint_; }
  const SubscriptionCounters& counters() const noexcept { return counters_; }

 private:
  bool is_heard(const void* data, std::int64_t arrival_ns) noexcept;

  std::string channel_;
  int encoded_size_;
  std::int64_t fingerprint_;
  struct Sender {
    std::int64_t session = 0;
    std::int64_t heard_ns = 0;  // its last message
    bool any = false;
  };
  std::int64_t silence_ns_ = -1;  // below zero: everybody is heard
  Sender heard_, before_;
  SubscriptionCounters counters_;
  struct Queue;
  std::unique_ptr<Queue> queue_;
};

/// Hears of messages that pass by, in the thread that takes or publishes them.
class MessageTap {
 public:
  /// `data`: the encoded message with its fingerprint.
  virtual void note(const std::string& channel, const void* data, int size) noexcept = 0;

 protected:
  ~MessageTap() = default;
};

/// Where messages go to and come from. Set-up: subscribe, then start. publish() neither allocates
/// nor throws and may be called by one thread at a time.
class MessageBus {
 public:
  virtual ~MessageBus() = default;
  /// Before start(). The bus owns the subscription.
  virtual Subscription& subscribe(const std::string& channel, int encoded_size,
                                  std::int64_t fingerprint, int depth) = 0;
  /// Before start(): SCHED_FIFO for the receiver's thread, as far as the system grants it, so that
  /// a busy machine does not make inputs old; 0, as it is without this call: ordinary scheduling.
  virtual void set_receiver_priority(int) noexcept {}
  virtual void start() = 0;  // receiver's thread, where there is one; throws std::runtime_error
  /// In place of start(), for a program that waits for messages: no thread receives but the one
  /// that calls receive(), so that none has to be woken for another. Throws as start() does.
  virtual void start_without_thread() = 0;
  /// After start_without_thread(): all that has come goes to the subscriptions. Where nothing has,
  /// waits for it, at most `timeout_ns`. False where nothing came, and at once on a bus whose
  /// messages are there as soon as they are published.
  virtual bool receive(std::int64_t timeout_ns) noexcept = 0;
  virtual void stop() noexcept = 0;
  /// False where the message does not fit one datagram or the system refuses it.
  virtual bool publish(const char* channel, const void* data, int size) noexcept = 0;
  /// Set-up: from now on publish_later() leaves to a thread of the bus's own, which has room for
  /// `depth` messages of at most `largest` encoded bytes. Without this call, and on a bus whose
  /// messages are there as soon as they are published, publish_later() is publish().
  virtual void start_publisher(int /*depth*/, int /*largest*/) {}
  /// As publish(), for what nobody acts upon within the cycle: costs the caller a copy. What is
  /// lost later is counted by unpublished().
  virtual bool publish_later(const char* channel, const void* data, int size) noexcept {
    return publish(channel, data, size);
  }
  /// Messages handed to publish_later() that never reached the network.
  virtual std::int64_t unpublished() const noexcept { return 0; }
  const DatagramCounters& datagrams() const noexcept { return datagrams_; }
  /// In the order of subscribing.
  const std::vector<const Subscription*>& subscriptions() const noexcept { return listed_; }

  /// Hears of all that the typed views of this bus take and publish; nullptr: nobody does.
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
};

/// LCM's UDP multicast, udpm://ADDRESS:PORT?ttl=N&recv_buf_size=BYTES. liblcm publishes; receiving
/// is our own, since one malformed packet kills a process that receives through liblcm: short
/// messages of subscribed channels only, size and fingerprint checked before anyone decodes. Throws
/// std::invalid_argument for a URL that is wrong and std::runtime_error with the remedy for one
/// that cannot be opened here.
std::unique_ptr<MessageBus> make_lcm_bus(const std::string& url);

/// In-process bus for tests and stepped runs: publish() offers to every subscription of the channel
/// at once, with the time of `clock_ns` as arrival. Several participants attach to one hub.
class MemoryHub;
std::shared_ptr<MemoryHub> make_memory_hub();
std::unique_ptr<MessageBus> make_memory_bus(std::shared_ptr<MemoryHub> hub);
/// Virtual time that messages arrive at; also lets a test look at everything that was published.
void set_time(MemoryHub& hub, std::int64_t now_ns) noexcept;
struct Published {
  std::string channel;
  std::vector<std::uint8_t> data;
  std::int64_t time_ns;
};
/// From now on keep a copy of each message (allocates; tests and replay).
void record(MemoryHub& hub, std::vector<Published>* into) noexcept;

/// A typed view: T is a type generated by lcm-gen whose size is fixed.
template <class T>
class TypedSubscription {
 public:
  TypedSubscription(MessageBus& bus, const std::string& channel, int depth)
      : bus_(&bus),
        raw_(&bus.subscribe(channel, T().getEncodedSize(), T::getHash(), depth)),
        buffer_(raw_->encoded_size()) {}

  /// False when there is none. Does not allocate for types of fixed size.
  bool take(T& message, std::int64_t& arrival_ns) noexcept {
    if (!raw_->take(buffer_.data(), arrival_ns)) return false;
    if (MessageTap* tap = bus_->tap())
      tap->note(raw_->channel(), buffer_.data(), raw_->encoded_size());
    return message.decode(buffer_.data(), 0, static_cast<int>(buffer_.size())) >= 0;
  }
  const SubscriptionCounters& counters() const noexcept { return raw_->counters(); }
  void hear_one_sender(std::int64_t silence_ns) noexcept { raw_->hear_one_sender(silence_ns); }

 private:
  MessageBus* bus_;
  Subscription* raw_;
  std::vector<std::uint8_t> buffer_;
};

/// kNow: in the thread that publishes; kLater: by the bus's own thread, where it has one.
enum class Urgency { kNow, kLater };

/// Encodes into a buffer of its own and publishes; a type of fixed size never allocates after the
/// first construction. Variable types allocate when they grow.
template <class T>
class TypedPublisher {
 public:
  TypedPublisher(MessageBus& bus, std::string channel, Urgency urgency = Urgency::kNow)
      : bus_(&bus),
        channel_(std::move(channel)),
        buffer_(T().getEncodedSize()),
        urgency_(urgency) {}

  /// Room for messages of `size` encoded bytes, so that publishing them does not allocate.
  void reserve(int size) {
    if (size > static_cast<int>(buffer_.size())) buffer_.resize(size);
  }

  bool publish(const T& message) noexcept {
    const int size = message.getEncodedSize();
    if (size > static_cast<int>(buffer_.size())) buffer_.resize(size);
    if (message.encode(buffer_.data(), 0, size) < 0) return false;
    if (MessageTap* tap = bus_->tap()) tap->note(channel_, buffer_.data(), size);
    return urgency_ == Urgency::kNow ? bus_->publish(channel_.c_str(), buffer_.data(), size)
                                     : bus_->publish_later(channel_.c_str(), buffer_.data(), size);
  }

 private:
  MessageBus* bus_;
  std::string channel_;
  std::vector<std::uint8_t> buffer_;
  Urgency urgency_;
};

}  // namespace palpate::bus
