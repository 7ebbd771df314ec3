#pragma once

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "rt/bus/lcm_bus.hpp"
#include "rt/bus/udpm_url.hpp"

namespace palpate::support {

/// One LCM datagram as sent on the network.
struct Datagram {
  std::vector<std::uint8_t> data;

  /// Empty if it is not a short message.
  std::string channel() const { return std::string(frame().channel); }
  std::vector<std::uint8_t> payload() const {
    const bus::UdpmFrame f = frame();
    return {f.payload, f.payload + f.payload_size};
  }

 private:
  bus::UdpmFrame frame() const {
    bus::DatagramCounters counters;
    bus::UdpmFrame f{};
    bus::parse_udpm_frame(data.data(), static_cast<int>(data.size()), counters, f);
    return f;
  }
};

/// A multicast group observed from outside the bus: every raw datagram, except one's own.
class Datagrams {
 public:
  explicit Datagrams(const std::string& url) : address_(bus::parse_udpm_url(url).socket_address()) {
    in_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    out_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const int on = 1, room = 8 << 20;
    const std::uint8_t ttl = 0;
    setsockopt(in_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    setsockopt(in_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    setsockopt(out_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
    ip_mreq membership{};
    membership.imr_multiaddr = address_.sin_addr;
    sockaddr_in own{};
    own.sin_family = AF_INET;
    if (bind(in_, reinterpret_cast<const sockaddr*>(&address_), sizeof address_) != 0 ||
        setsockopt(in_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0 ||
        bind(out_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
      throw std::runtime_error("no multicast on " + url);
    socklen_t length = sizeof own;
    getsockname(out_, reinterpret_cast<sockaddr*>(&own), &length);
    own_port_ = own.sin_port;
  }
  ~Datagrams() {
    close(in_);
    close(out_);
  }
  Datagrams(const Datagrams&) = delete;
  Datagrams& operator=(const Datagrams&) = delete;

  int descriptor() const { return in_; }

  /// The oldest datagram that is waiting; false if there is none.
  bool take(Datagram& datagram) {
    sockaddr_in from{};
    for (;;) {
      socklen_t length = sizeof from;
      datagram.data.resize(65536);
      const ssize_t size = recvfrom(in_, datagram.data.data(), datagram.data.size(), MSG_DONTWAIT,
                                    reinterpret_cast<sockaddr*>(&from), &length);
      if (size < 0) return false;
      datagram.data.resize(static_cast<std::size_t>(size));
      if (from.sin_port != own_port_) return true;
    }
  }

  void send(const Datagram& datagram) {
    sendto(out_, datagram.data.data(), datagram.data.size(), 0,
           reinterpret_cast<const sockaddr*>(&address_), sizeof address_);
  }

 private:
  sockaddr_in address_;
  int in_ = -1, out_ = -1;
  in_port_t own_port_ = 0;
};

}  // namespace palpate::support
