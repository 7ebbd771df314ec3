#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rt/bus/message_bus.hpp"

namespace palpate::faults {

/// Messages in the order in which they arrive, each with the time of its arrival.
using Stream = std::vector<bus::Published>;

/// Header of every message, after its fingerprint.
struct Header {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int64_t session = 0;
};
inline constexpr int kFingerprintSize = 8;
inline constexpr int kHeaderSize = 28;  // fingerprint included

Header header_of(const bus::Published& message);
void put_header(bus::Published& message, const Header& header);

/// Whether a sensor or the robot sent it.
bool is_sensor(const std::string& channel);

/// Byte offsets of the values that the daemon reads from a sensor's message; all are doubles.
std::vector<int> number_offsets(const bus::Published& message);
double number_at(const bus::Published& message, int offset);
void put_number(bus::Published& message, int offset, double value);

/// Duration of a fault, s; half-open at the end.
struct Window {
  double begin = 0;
  double end = 0;
  bool holds(std::int64_t time_ns) const {
    const double t = 1e-9 * static_cast<double>(time_ns);
    return t >= begin - 1e-9 && t < end - 1e-9;
  }
};

}  // namespace palpate::faults
