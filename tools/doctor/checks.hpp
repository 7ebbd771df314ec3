#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "rt/bus/udpm_url.hpp"
#include "rt/config/node.hpp"
#include "tools/doctor/finding.hpp"
#include "tools/doctor/machine.hpp"
#include "tools/record/recorder.hpp"

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

/// Requirements of a configuration of palpated on its machine; the defaults without one.
struct Needs {
  bus::UdpmUrl control = bus::parse_udpm_url("udpm://239.255.76.67:7667?ttl=0");
  bus::UdpmUrl housekeeping = bus::parse_udpm_url("udpm://239.255.76.68:7668?ttl=0");
  int fifo_priority = 50;  // 0: none
  int cpu = -1;            // -1: any
  bool lock_memory = true;
  std::string record_folder = ".";  // of logs and records
};

/// Throws config::Error and std::invalid_argument (for URLs).
Needs needs_of(const config::Node& root);

/// Kernel and processors: preemption, priorities, locked memory, throttling, frequency, idle
/// states, isolation, clock source, instructions.
Findings check_real_time(const Machine& machine, const Needs& needs);

/// Sockets and routes: buffer, multicast, ttl, URLs, other receivers, other daemons.
Findings check_network(const Machine& machine, const Needs& needs);

/// LCM, the BLAS, Java and the spy. `spy_jar`: from the machine's root.
Findings check_programs(const Machine& machine, const std::string& spy_jar);

/// Disk space for logs, by `free_space`.
Findings check_disk(const Needs& needs, const record::FreeSpace& free_space);

/// Whether palpated would accept the configuration: it is built as the daemon builds it, with every
/// mesh, material and model that it names.
Findings check_configuration(const std::string& path, const std::vector<std::string>& overrides);

/// Whether a datagram sent to a group of this machine is received; from HEALTH, the number of
/// publishing daemons. Listens for `seconds`.
Findings check_live(const Needs& needs, double seconds);

/// A channel on which palpated receives or publishes.
struct Channel {
  std::string name;
  std::string type;  // of lcmtypes/
  std::string url;
  bool is_heard = false;  // otherwise palpated publishes on it
  double rate = 0;  // messages/s that it publishes; 0: on change, or received at the sender's rate
  std::string about;  // first line of the type's comment
};

/// All channels of a configuration of palpated, inputs first, before it runs: it is built as the
/// daemon builds it and runs for some seconds of virtual time, without other participants, on a bus
/// in memory. Throws config::Error.
std::vector<Channel> channels_of(const std::string& path,
                                 const std::vector<std::string>& overrides);

void print(const std::vector<Channel>& channels, std::ostream& out);
nlohmann::json to_json(const std::vector<Channel>& channels);

}  // namespace palpate::doctor
