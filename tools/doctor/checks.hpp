#pragma once

#include <string>

#include "tools/doctor/finding.hpp"
#include "tools/doctor/machine.hpp"
#include "tools/doctor/needs.hpp"
#include "tools/record/recorder.hpp"

namespace palpate::doctor {

/// Kernel and processors: preemption, priorities, locked memory, throttling, frequency, idle
/// states, isolation, clock source, instructions.
Findings check_real_time(const Machine& machine, const Needs& needs);

/// Sockets and routes: buffer, multicast, ttl, URLs, other receivers, other daemons.
Findings check_network(const Machine& machine, const Needs& needs);

/// LCM, Java and the spy. `spy_jar`: from the machine's root.
Findings check_programs(const Machine& machine, const std::string& spy_jar);

/// Disk space for logs, by `free_space`.
Findings check_disk(const Needs& needs, const record::FreeSpace& free_space);

/// Whether palpated would accept the configuration: it is built as the daemon builds it, with every
/// mesh, material and model that it names.
Findings check_configuration(const std::string& path, const std::vector<std::string>& overrides);

/// Whether a datagram sent to a group of this machine is received; from HEALTH, the number of
/// publishing daemons. Listens for `seconds`.
Findings check_live(const Needs& needs, double seconds);

}  // namespace palpate::doctor
