#include "tools/lab/inject/sender.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <thread>

namespace palpate::inject {
namespace {

constexpr double kBurstTime = 1e-3;  // s
constexpr std::size_t kLargestBurst = 256;

}  // namespace

Sender::Sender(const bus::UdpmUrl& url, double rate)
    : address_(url.socket_address()),
      rate_(rate),
      burst_(rate > 0 ? std::clamp<std::size_t>(static_cast<std::size_t>(rate * kBurstTime), 1,
                                                kLargestBurst)
                      : kLargestBurst),
      waiting_(burst_) {
  bus::require_route(url);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) throw std::runtime_error(bus::explain_socket_error("open", url, errno));
  const auto ttl = static_cast<std::uint8_t>(url.ttl);
  setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof(ttl));
}

Sender::~Sender() { close(socket_); }

double Sender::elapsed() const {
  return sent_ + refused_ == 0 ? 0 : std::chrono::duration<double>(Clock::now() - began_).count();
}

void Sender::send(const std::vector<std::uint8_t>& datagram) {
  waiting_[waiting_count_++] = datagram;
  if (waiting_count_ == burst_) flush();
}

void Sender::flush() {
  if (waiting_count_ == 0) return;
  const std::int64_t before = sent_ + refused_;
  if (before == 0) began_ = Clock::now();
  if (rate_ > 0) {
    const std::chrono::duration<double> due(static_cast<double>(before) / rate_);
    std::this_thread::sleep_until(began_ + std::chrono::duration_cast<Clock::duration>(due));
  }
  std::vector<iovec> parts(waiting_count_);
  std::vector<mmsghdr> messages(waiting_count_);
  for (std::size_t i = 0; i < waiting_count_; ++i) {
    parts[i] = {waiting_[i].data(), waiting_[i].size()};
    // Addressed one by one: connected, they would leave by another interface than that of the
    // route.
    messages[i].msg_hdr.msg_name = &address_;
    messages[i].msg_hdr.msg_namelen = sizeof(address_);
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
  std::size_t done = 0;
  while (done < waiting_count_) {
    const int count =
        sendmmsg(socket_, messages.data() + done, static_cast<unsigned>(waiting_count_ - done), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {  // the first of them was refused
      ++refused_;
      ++done;
      continue;
    }
    sent_ += count;
    done += static_cast<std::size_t>(count);
  }
  waiting_count_ = 0;
}

}  // namespace palpate::inject
