#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/sensors/biotac.hpp"
#include "tools/collect/protocol.hpp"

namespace palpate::collect {

/// One reading of finger and probe.
struct Sample {
  std::int64_t time_us = 0;  // of the trial
  sensors::BiotacReading biotac;
  math::Vector6d wrench;  // N, N m: as the probe's force-torque sensor reads it (Bench)
};

/// How unlike the fingers of a collection are to each other.
struct Variety {
  double skin = 0;      // deviation of the logarithm of stiffness, reach and pressure area
  double place = 5e-4;  // m, deviation of where a probe stands beside the centre of its area
};

/// An emulated finger on probes that stand on an emulated force-torque sensor, whose axes and
/// origin are those of T and which reads what the finger exerts on the probe. Each trial has a
/// finger of its own: other rest counts, and another skin as `variety` says. What is true is told
/// to nobody: samples hold what the sensors read.
class Bench {
 public:
  Bench(const sensors::SensorTable& table, std::uint64_t seed, const Variety& variety)
      : table_(table), seed_(seed), variety_(variety) {}

  /// All samples of a trial, at the BioTac's rate. The same trial and seed give the same samples.
  std::vector<Sample> run(const Trial& trial) const;

 private:
  sensors::SensorTable table_;
  std::uint64_t seed_;
  Variety variety_;
};

}  // namespace palpate::collect
