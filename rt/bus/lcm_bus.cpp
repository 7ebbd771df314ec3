#include "rt/bus/lcm_bus.hpp"

#include <lcm/lcm.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include "rt/bus/fragments.hpp"
#include "rt/bus/telemetry_publisher.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/real_time.hpp"

namespace palpate::bus {
namespace {

constexpr char kShortMagic[] = {'L', 'C', '0', '2'};
constexpr char kFragmentMagic[] = {'L', 'C', '0', '3'};
static_assert(kLargestShortMessage == 65507 - kUdpmHeaderSize);

// larger than any UDP datagram, so that none is truncated
constexpr std::size_t kBufferSize = 65536;
// Requested without recv_buf_size; without privilege the kernel limits it to net.core.rmem_max.
constexpr int kWantedReceiveBuffer = 16 << 20;

constexpr std::int64_t kLongestWork = 800'000;  // ns, maximum continuous work

void count(std::atomic<std::int64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

bool parse_udpm_frame(const std::uint8_t* data, int size, DatagramCounters& counters,
                      UdpmFrame& frame) noexcept {
  count(counters.received);
  const auto starts_with = [&](const auto& magic) {
    return size >= kUdpmHeaderSize && std::memcmp(data, magic, sizeof(magic)) == 0;
  };
  if (starts_with(kFragmentMagic)) return count(counters.fragmented), false;
  if (!starts_with(kShortMagic)) return count(counters.malformed), false;

  const std::uint8_t* name = data + kUdpmHeaderSize;
  const int searched = std::min(size - kUdpmHeaderSize, kLongestChannel + 1);
  const void* zero = std::memchr(name, 0, static_cast<std::size_t>(searched));
  if (zero == nullptr || zero == name) return count(counters.malformed), false;
  const auto length = static_cast<int>(static_cast<const std::uint8_t*>(zero) - name);
  frame.channel = {reinterpret_cast<const char*>(name), static_cast<std::size_t>(length)};
  frame.payload = name + length + 1;
  frame.payload_size = size - kUdpmHeaderSize - length - 1;
  return true;
}

void UdpmSocket::open(const UdpmUrl& url) {
  close();
  try {
    join(url);
  } catch (...) {
    close();
    throw;
  }
  buffer_.resize(kBufferSize);
}

void UdpmSocket::close() noexcept {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  overflows_seen_ = 0;
}

void UdpmSocket::join(const UdpmUrl& url) {
  const auto require = [&url](bool success, const char* doing) {
    if (!success) throw std::runtime_error(explain_socket_error(doing, url, errno));
  };
  descriptor_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  require(descriptor_ >= 0, "make a socket for");

  const int on = 1;
  require(setsockopt(descriptor_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) == 0,
          "share the port of");
  setsockopt(descriptor_, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on));
  const int wanted = url.receive_buffer_size > 0 ? url.receive_buffer_size : kWantedReceiveBuffer;
  // the second option requires a privilege and then ignores the limit
  for (const int option : {SO_RCVBUF, SO_RCVBUFFORCE}) {
    setsockopt(descriptor_, SOL_SOCKET, option, &wanted, sizeof(wanted));
    int given = 0;
    socklen_t length = sizeof(given);
    getsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &given, &length);
    receive_buffer_size_ = given / 2;  // the kernel doubles the requested size for its own overhead
    if (receive_buffer_size_ >= wanted) break;
  }

  // Bound to the group rather than to any address, the socket receives datagrams of this group
  // only.
  const sockaddr_in address = url.socket_address();
  require(bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0,
          "listen to");
  ip_mreq membership{};
  membership.imr_multiaddr = address.sin_addr;
  membership.imr_interface.s_addr = htonl(INADDR_ANY);
  require(
      setsockopt(descriptor_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof(membership)) == 0,
      "join the multicast group of");
}

int UdpmSocket::receive(DatagramCounters& counters) noexcept {
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(std::uint32_t))];
  iovec room{buffer_.data(), buffer_.size()};
  sockaddr_in from{};
  msghdr header{};
  header.msg_name = &from;
  header.msg_iov = &room;
  header.msg_iovlen = 1;
  ssize_t size = 0;
  do {
    header.msg_namelen = sizeof(from);
    header.msg_control = control;
    header.msg_controllen = sizeof(control);
    size = recvmsg(descriptor_, &header, 0);
  } while (size < 0 && errno == EINTR);
  if (size < 0) return -1;
  sender_ = std::uint64_t{from.sin_addr.s_addr} << 16 | from.sin_port;
  for (const cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr;
       part = CMSG_NXTHDR(&header, const_cast<cmsghdr*>(part))) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t overflows = 0;
    std::memcpy(&overflows, CMSG_DATA(part), sizeof(overflows));
    counters.overflowed.fetch_add(overflows - overflows_seen_, std::memory_order_relaxed);
    overflows_seen_ = overflows;
  }
  return static_cast<int>(size);
}

UdpmReceiver::UdpmReceiver(DatagramCounters& counters, int largest) : counters_(counters) {
  if (largest != 0) fragments_ = std::make_unique<FragmentAssembler>(largest);
}

UdpmReceiver::~UdpmReceiver() { stop(); }

Subscription& UdpmReceiver::subscribe(const std::string& channel, int encoded_size,
                                      std::int64_t fingerprint, int depth) {
  if (started()) throw std::logic_error("subscribe to " + channel + " before the bus is started");
  subscriptions_.push_back(
      std::make_unique<Subscription>(channel, encoded_size, fingerprint, depth));
  return *subscriptions_.back();
}

void UdpmReceiver::open(const UdpmUrl& url) {
  if (started()) return;
  socket_.open(url);
  stop_.store(false);
}

void UdpmReceiver::start(const UdpmUrl& url) {
  if (started()) return;
  open(url);
  wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake_ < 0) {
    const int error = errno;
    socket_.close();
    throw std::runtime_error(explain_socket_error("make an event for", url, error));
  }
  thread_ = loop::start_helper_thread("palpate-receive", [this] { receive_until_stopped(); });
}

void UdpmReceiver::stop() noexcept {
  stop_.store(true);
  if (thread_.joinable()) {
    const std::uint64_t one = 1;
    while (write(wake_, &one, sizeof(one)) < 0 && errno == EINTR) {
    }
    thread_.join();
  }
  socket_.close();
  if (wake_ >= 0) close(wake_);
  wake_ = -1;
}

void UdpmReceiver::receive_until_stopped() noexcept {
  if (fifo_priority_ > 0) loop::take_fifo(fifo_priority_);
  pollfd watched[] = {{socket_.descriptor(), POLLIN, 0}, {wake_, POLLIN, 0}};
  while (!stop_.load(std::memory_order_relaxed)) {
    poll(watched, 2, -1);
    busy_since_ns_ = loop::monotonic_ns();
    while (!stop_.load(std::memory_order_relaxed) && receive_one()) rest_if_flooded();
  }
}

/// With a real-time priority, a message flood could monopolise a processor and consume the loop's
/// share of the system's real-time budget.
void UdpmReceiver::rest_if_flooded() noexcept {
  if (fifo_priority_ == 0 || arrival_ns_ - busy_since_ns_ < kLongestWork) return;
  constexpr timespec kRest{0, 200'000};
  clock_nanosleep(CLOCK_MONOTONIC, 0, &kRest, nullptr);
  busy_since_ns_ = loop::monotonic_ns();
}

bool UdpmReceiver::receive(std::int64_t timeout_ns) noexcept {
  if (!started()) return false;
  if (receive_all()) return true;
  if (timeout_ns <= 0) return false;
  // Sleeps immediately: on a loaded machine a thread that yields or spins waits longest.
  pollfd watched{socket_.descriptor(), POLLIN, 0};
  const timespec most{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
  ppoll(&watched, 1, &most, nullptr);
  return receive_all();
}

bool UdpmReceiver::receive_all() noexcept {
  bool any = false;
  while (!stop_.load(std::memory_order_relaxed) && receive_one()) any = true;
  return any;
}

bool UdpmReceiver::receive_one() noexcept {
  const int size = socket_.receive(counters_);
  if (size < 0) return false;
  arrival_ns_ = loop::monotonic_ns();
  handle(socket_.data(), size, arrival_ns_, socket_.sender());
  return true;
}

void UdpmReceiver::handle(const std::uint8_t* data, int size, std::int64_t arrival_ns,
                          std::uint64_t sender) noexcept {
  UdpmFrame frame{};
  const bool is_message = fragments_ && FragmentAssembler::is_fragment(data, size)
                              ? fragments_->take(data, size, sender, arrival_ns, counters_, frame)
                              : parse_udpm_frame(data, size, counters_, frame);
  if (!is_message) return;
  bool subscribed = false;
  for (const auto& subscription : subscriptions_) {
    if (subscription->channel() != frame.channel) continue;
    subscribed = true;
    subscription->offer(frame.payload, frame.payload_size, arrival_ns);
  }
  if (!subscribed) count(counters_.unsubscribed);
}

namespace {

/// Publishes through liblcm, which starts its own receiver only for a subscription, and none is
/// made here.
class LcmSender {
 public:
  explicit LcmSender(const UdpmUrl& url) : lcm_(lcm_create(url.text().c_str())) {
    if (!lcm_)
      throw std::runtime_error("liblcm cannot open " + url.text() + "; its message is above");
  }

  bool publish(const char* channel, const void* data, int size) noexcept {
    if (!fits_one_datagram(channel, size)) return false;
    return lcm_publish(lcm_.get(), channel, data, static_cast<unsigned>(size)) == 0;
  }

 private:
  struct Destroy {
    void operator()(lcm_t* lcm) const noexcept { lcm_destroy(lcm); }
  };
  std::unique_ptr<lcm_t, Destroy> lcm_;
};

/// liblcm finds a missing route as well, but reports it on stderr and returns nothing to explain.
const UdpmUrl& with_route(const UdpmUrl& url) {
  require_route(url);
  return url;
}

class LcmBus final : public MessageBus {
 public:
  LcmBus(const UdpmUrl& url, int largest)
      : url_(with_route(url)), receiver_(datagrams_, largest), sender_(url) {}

  Subscription& subscribe(const std::string& channel, int encoded_size, std::int64_t fingerprint,
                          int depth) override {
    return listed(receiver_.subscribe(channel, encoded_size, fingerprint, depth));
  }
  void set_receiver_priority(int fifo_priority) noexcept override {
    receiver_.set_priority(fifo_priority);
  }
  void start() override { receiver_.start(url_); }
  void start_without_thread() override { receiver_.open(url_); }
  bool receive(std::int64_t timeout_ns) noexcept override { return receiver_.receive(timeout_ns); }
  void stop() noexcept override { receiver_.stop(); }

  bool publish(const char* channel, const void* data, int size) noexcept override {
    return sender_.publish(channel, data, size);
  }
  void start_publisher(int depth, int largest) override {
    // liblcm locks while it sends: a separate instance for the publisher never delays a command
    publisher_ = std::make_unique<TelemetryPublisher>(
        [sender = std::make_shared<LcmSender>(url_)](const char* channel, const void* data,
                                                     int size) {
          return sender->publish(channel, data, size);
        },
        depth, largest);
  }
  Outlet* outlet() noexcept override { return publisher_.get(); }
  std::int64_t unpublished() const noexcept override { return publisher_ ? publisher_->lost() : 0; }

 private:
  UdpmUrl url_;
  UdpmReceiver receiver_;
  LcmSender sender_;
  std::unique_ptr<TelemetryPublisher> publisher_;
};

}  // namespace

std::unique_ptr<MessageBus> make_lcm_bus(const std::string& url) { return make_lcm_bus(url, 0); }

std::unique_ptr<MessageBus> make_lcm_bus(const std::string& url, int largest) {
  return std::make_unique<LcmBus>(parse_udpm_url(url), largest);
}

}  // namespace palpate::bus
