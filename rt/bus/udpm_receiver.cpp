#include "rt/bus/udpm_receiver.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include "rt/bus/udpm_frame.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/helper_thread.hpp"
#include "rt/loop/real_time.hpp"

namespace palpate::bus {
namespace {

// More than any UDP datagram, so that none is cut short.
constexpr std::size_t kBufferSize = 65536;
// Without recv_buf_size; the kernel cuts it down to net.core.rmem_max.
constexpr int kWantedReceiveBuffer = 16 << 20;
constexpr std::int64_t kLongestWork = 800'000;  // ns, without a rest

void increment(std::atomic<std::int64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

void UdpmReceiver::Descriptor::reset(int value) noexcept {
  if (value_ >= 0) close(value_);
  value_ = value;
}

Subscription& UdpmReceiver::subscribe(const std::string& channel, int encoded_size,
                                      std::int64_t fingerprint, int depth) {
  if (started()) throw std::logic_error("subscribe to " + channel + " before the bus is started");
  subscriptions_.push_back(
      std::make_unique<Subscription>(channel, encoded_size, fingerprint, depth));
  return *subscriptions_.back();
}

void UdpmReceiver::start(const UdpmUrl& url) {
  if (started()) return;
  open(url);
  thread_ = loop::start_helper_thread("palpate-receive", [this] { receive_until_stopped(); });
}

void UdpmReceiver::stop() noexcept {
  stop_.store(true);
  if (thread_.joinable()) {
    const std::uint64_t one = 1;
    while (write(wake_.get(), &one, sizeof(one)) < 0 && errno == EINTR) {
    }
    thread_.join();
  }
  socket_.reset(-1);
  wake_.reset(-1);
}

void UdpmReceiver::open(const UdpmUrl& url) {
  if (started()) return;
  try {
    join_group(url);
  } catch (...) {
    socket_.reset(-1);
    throw;
  }
  buffer_.resize(kBufferSize);
  overflows_seen_ = 0;
  stop_.store(false);
}

void UdpmReceiver::join_group(const UdpmUrl& url) {
  const auto require = [&url](bool success, const char* doing) {
    if (!success) throw std::runtime_error(explain_socket_error(doing, url, errno));
  };
  wake_.reset(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  require(wake_.get() >= 0, "make an event for");
  socket_.reset(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  require(socket_.get() >= 0, "make a socket for");
  const int fd = socket_.get();

  const int on = 1;
  require(setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) == 0, "share the port of");
  setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on));
  const int wanted = url.receive_buffer_size > 0 ? url.receive_buffer_size : kWantedReceiveBuffer;
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof(wanted));
  int given = 0;
  socklen_t length = sizeof(given);
  getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &given, &length);
  receive_buffer_size_ = given / 2;  // the kernel doubles what is asked for, to cover its own needs

  // Bound to the group, not to any address, the socket sees this group alone.
  const sockaddr_in address = url.socket_address();
  require(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0, "listen to");
  ip_mreq membership{};
  membership.imr_multiaddr = address.sin_addr;
  membership.imr_interface.s_addr = htonl(INADDR_ANY);
  require(setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof(membership)) == 0,
          "join the multicast group of");
}

void UdpmReceiver::receive_until_stopped() noexcept {
  if (fifo_priority_ > 0) loop::take_fifo(fifo_priority_);
  pollfd watched[] = {{socket_.get(), POLLIN, 0}, {wake_.get(), POLLIN, 0}};
  while (!stop_.load(std::memory_order_relaxed)) {
    poll(watched, 2, -1);
    busy_since_ns_ = loop::monotonic_ns();
    while (!stop_.load(std::memory_order_relaxed) && receive_one()) rest_if_flooded();
  }
}

/// With the priority of a real-time thread, whoever floods could take a processor from all others,
/// and what the system then allows such threads from the loop.
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
  // Asleep at once: on a busy machine who yields or spins waits longest.
  pollfd watched{socket_.get(), POLLIN, 0};
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
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(std::uint32_t))];
  iovec room{buffer_.data(), buffer_.size()};
  msghdr header{};
  header.msg_iov = &room;
  header.msg_iovlen = 1;
  header.msg_control = control;
  header.msg_controllen = sizeof(control);
  const ssize_t size = recvmsg(socket_.get(), &header, 0);
  if (size < 0) return errno == EINTR;
  arrival_ns_ = loop::monotonic_ns();
  for (const cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr;
       part = CMSG_NXTHDR(&header, const_cast<cmsghdr*>(part))) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t overflows = 0;
    std::memcpy(&overflows, CMSG_DATA(part), sizeof(overflows));
    counters_.overflowed.fetch_add(overflows - overflows_seen_, std::memory_order_relaxed);
    overflows_seen_ = overflows;
  }
  handle(buffer_.data(), static_cast<int>(size), arrival_ns_);
  return true;
}

void UdpmReceiver::handle(const std::uint8_t* data, int size, std::int64_t arrival_ns) noexcept {
  increment(counters_.received);
  UdpmFrame frame{};
  switch (parse_udpm_frame(data, size, frame)) {
    case FrameKind::kMalformed:
      return increment(counters_.malformed);
    case FrameKind::kFragment:
      return increment(counters_.fragmented);
    case FrameKind::kMessage:
      break;
  }
  bool subscribed = false;
  for (const auto& subscription : subscriptions_) {
    if (subscription->channel() != frame.channel) continue;
    subscribed = true;
    subscription->offer(frame.payload, frame.payload_size, arrival_ns);
  }
  if (!subscribed) increment(counters_.unsubscribed);
}

}  // namespace palpate::bus
