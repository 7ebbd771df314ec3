#include "rt/bus/udpm_receiver.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <stdexcept>

#include "rt/bus/udpm_frame.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/real_time.hpp"

namespace palpate::bus {
namespace {

constexpr std::int64_t kLongestWork = 800'000;  // ns, maximum continuous work

void count(std::atomic<std::int64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

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
  handle(socket_.data(), size, arrival_ns_);
  return true;
}

void UdpmReceiver::handle(const std::uint8_t* data, int size, std::int64_t arrival_ns) noexcept {
  count(counters_.received);
  UdpmFrame frame{};
  switch (parse_udpm_frame(data, size, frame)) {
    case FrameKind::kMalformed:
      return count(counters_.malformed);
    case FrameKind::kFragment:
      return count(counters_.fragmented);
    case FrameKind::kMessage:
      break;
  }
  bool subscribed = false;
  for (const auto& subscription : subscriptions_) {
    if (subscription->channel() != frame.channel) continue;
    subscribed = true;
    subscription->offer(frame.payload, frame.payload_size, arrival_ns);
  }
  if (!subscribed) count(counters_.unsubscribed);
}

}  // namespace palpate::bus
