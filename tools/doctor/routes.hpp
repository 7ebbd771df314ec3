#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/doctor/machine.hpp"

namespace palpate::doctor {

/// The device by which datagrams to `address` leave, by the routing table: the longest prefix, then
/// the smallest metric. Empty if there is no route.
std::optional<std::string> route_to(const Machine& machine, const std::string& address);

/// A UDP socket that is bound to a port.
struct BoundSocket {
  std::string address;  // dotted; 0.0.0.0: any
  int port = 0;
  std::int64_t drops = 0;  // datagrams lost because its buffer was full
  std::int64_t inode = 0;
};
std::vector<BoundSocket> udp_sockets(const Machine& machine, int port);

/// A process that holds a socket.
struct Holder {
  int pid = 0;
  std::string name;
  char state = '?';  // as in /proc: T stopped, Z zombie
};
std::optional<Holder> holder_of(const Machine& machine, std::int64_t inode);

}  // namespace palpate::doctor
