#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/doctor/machine.hpp"

namespace palpate::doctor {

/// The device that datagrams to `address` leave by, as the routing table says: the longest prefix,
/// then the smallest metric. Nothing where there is no route.
std::optional<std::string> route_to(const Machine& machine, const std::string& address);

/// A UDP socket that is bound to a port.
struct BoundSocket {
  std::string address;  // dotted; 0.0.0.0: any
  int port = 0;
  std::int64_t drops = 0;  // datagrams lost since its buffer was full
  std::int64_t inode = 0;
};
std::vector<BoundSocket> udp_sockets(const Machine& machine, int port);

/// A process that holds a socket.
struct Holder {
  int pid = 0;
  std::string name;
  char state = '?';  // as /proc says it: T stopped, Z dead
};
std::optional<Holder> holder_of(const Machine& machine, std::int64_t inode);

}  // namespace palpate::doctor
