#include "rt/bus/udpm_socket.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace palpate::bus {
namespace {

// larger than any UDP datagram, so that none is truncated
constexpr std::size_t kBufferSize = 65536;
// Requested without recv_buf_size; without privilege the kernel limits it to net.core.rmem_max.
constexpr int kWantedReceiveBuffer = 16 << 20;

}  // namespace

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
  msghdr header{};
  header.msg_iov = &room;
  header.msg_iovlen = 1;
  ssize_t size = 0;
  do {
    header.msg_control = control;
    header.msg_controllen = sizeof(control);
    size = recvmsg(descriptor_, &header, 0);
  } while (size < 0 && errno == EINTR);
  if (size < 0) return -1;
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

}  // namespace palpate::bus
