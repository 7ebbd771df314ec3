#include "rt/bus/instance_lock.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>

#include "rt/bus/udpm_url.hpp"

namespace palpate::bus {
namespace {

constexpr std::size_t kLongestRole = 32;

struct Address {
  sockaddr_un value{};
  socklen_t length = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&value); }
};

/// Abstract names begin with a zero byte and are delimited by the length.
Address abstract_address(const std::string& name) {
  Address address;
  address.value.sun_family = AF_UNIX;
  std::memcpy(address.value.sun_path + 1, name.data(), name.size());
  address.length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return address;
}

/// " (process N)" for the process that listens at the address; empty if unknown.
std::string holder(const Address& address) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return {};
  ucred peer{};
  socklen_t length = sizeof(peer);
  const bool known = connect(fd, address.get(), address.length) == 0 &&
                     getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 && peer.pid > 0;
  close(fd);
  return known ? " (process " + std::to_string(peer.pid) + ")" : "";
}

}  // namespace

InstanceLock::InstanceLock(const std::string& url, const std::string& role) {
  if (role.empty() || role.size() > kLongestRole)
    throw std::invalid_argument("role \"" + role + "\" must have 1 to 32 characters");
  const UdpmUrl parsed = parse_udpm_url(url);
  const Address address = abstract_address("palpate/" + role + "/" + parsed.group());
  socket_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ >= 0 && bind(socket_, address.get(), address.length) == 0 && listen(socket_, 1) == 0)
    return;
  const int error = errno;
  if (socket_ >= 0) close(socket_);
  if (error == EADDRINUSE)
    throw std::runtime_error("another " + role + holder(address) + " already runs on " +
                             parsed.text() + "; stop it or use another URL");
  throw std::runtime_error("cannot lock " + parsed.text() + ": " + std::strerror(error));
}

InstanceLock::~InstanceLock() { close(socket_); }

}  // namespace palpate::bus
