#include "datagrams.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include "tools/bridge/common/stream.hpp"

namespace palpate::franka_bridge {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

class UdpDatagrams final : public Datagrams {
 public:
  explicit UdpDatagrams(const std::string& host) : peer_(bridge::ipv4_address(host, 0)) {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_ANY);
    socklen_t size = sizeof(own);
    if (socket_ < 0 || ::bind(socket_, reinterpret_cast<const sockaddr*>(&own), size) != 0 ||
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size) != 0)
      throw std::runtime_error(std::string("no UDP socket: ") + std::strerror(errno));
    port_ = ntohs(own.sin_port);
  }
  ~UdpDatagrams() override { ::close(socket_); }
  UdpDatagrams(const UdpDatagrams&) = delete;
  UdpDatagrams& operator=(const UdpDatagrams&) = delete;

  std::uint16_t port() const override { return port_; }

  int receive(std::uint8_t* to, int size) override {
    while (true) {
      sockaddr_in from{};
      socklen_t length = sizeof(from);
      const ssize_t count = ::recvfrom(socket_, to, static_cast<std::size_t>(size), MSG_TRUNC,
                                       reinterpret_cast<sockaddr*>(&from), &length);
      if (count < 0) return -1;
      if (from.sin_addr.s_addr != peer_.sin_addr.s_addr) continue;
      peer_.sin_port = from.sin_port;
      return static_cast<int>(count);
    }
  }

  void send(const std::uint8_t* data, int size) override {
    if (peer_.sin_port == 0) return;
    ::sendto(socket_, data, static_cast<std::size_t>(size), 0,
             reinterpret_cast<const sockaddr*>(&peer_), sizeof(peer_));
  }

  void wait(std::int64_t until_ns) override {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const std::int64_t left_ns = until_ns - (now.tv_sec * kNsPerSecond + now.tv_nsec);
    if (left_ns <= 0) return;
    const timespec timeout{left_ns / kNsPerSecond, left_ns % kNsPerSecond};
    pollfd one{socket_, POLLIN, 0};
    ::ppoll(&one, 1, &timeout, nullptr);
  }

 private:
  sockaddr_in peer_;
  int socket_ = -1;
  std::uint16_t port_ = 0;
};

}  // namespace

std::unique_ptr<Datagrams> make_udp_datagrams(const std::string& host) {
  return std::make_unique<UdpDatagrams>(host);
}

}  // namespace palpate::franka_bridge
