#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>

#include "rt/bus/udpm_url.hpp"

namespace palpate::bus::wire {

/// Sends raw datagrams to a group, as any host on the network could.
class Injector {
 public:
  explicit Injector(const UdpmUrl& url)
      : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)), address_(url.socket_address()) {
    const std::uint8_t ttl = 0;
    setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof(ttl));
  }
  ~Injector() { close(socket_); }
  Injector(const Injector&) = delete;
  Injector& operator=(const Injector&) = delete;

  bool send(const void* data, std::size_t size) {
    return sendto(socket_, data, size, 0, reinterpret_cast<const sockaddr*>(&address_),
                  sizeof(address_)) == static_cast<ssize_t>(size);
  }

 private:
  int socket_;
  sockaddr_in address_;
};

/// Whether a datagram to the group is received by a plain socket on this machine.
inline bool multicast_works(const UdpmUrl& url) {
  const sockaddr_in address = url.socket_address();
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  ip_mreq membership{};
  membership.imr_multiaddr = address.sin_addr;
  bool works =
      bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 &&
      setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof(membership)) == 0 &&
      Injector(url).send("?", 1);
  pollfd readable{fd, POLLIN, 0};
  works = works && poll(&readable, 1, 2000) == 1;
  close(fd);
  return works;
}

}  // namespace palpate::bus::wire

/// Skips the test if this machine has no multicast.
#define PALPATE_REQUIRE_MULTICAST(url)                             \
  if (!palpate::bus::wire::multicast_works(url))                   \
  GTEST_SKIP() << "multicast does not work here: " << (url).text() \
               << "; add a route with `ip route add 224.0.0.0/4 dev lo`"
