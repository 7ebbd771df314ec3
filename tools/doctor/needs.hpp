#pragma once

#include <string>

#include "rt/bus/udpm_url.hpp"
#include "rt/config/node.hpp"

namespace palpate::doctor {

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

}  // namespace palpate::doctor
