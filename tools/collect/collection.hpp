#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "sim/sensors/biotac.hpp"
#include "tools/collect/protocol.hpp"

namespace palpate::collect {

/// One reading of finger and probe.
struct Sample {
  std::int64_t time_us = 0;  // since the start of the trial
  sensors::BiotacReading biotac;
  math::Vector6d wrench;  // N, N m: as the probe's force-torque sensor reads it (Bench)
};

/// Variation between the fingers of a collection.
struct Variety {
  double skin = 0;      // standard deviation of the logarithm of stiffness, reach and pressure area
  double place = 5e-4;  // m, standard deviation of a probe's offset from the centre of its area
};

/// An emulated finger on probes mounted on an emulated force-torque sensor, whose axes and origin
/// are those of T and which reads the wrench of the finger on the probe. Each trial has its own
/// finger: different rest counts, and a different skin according to `variety`. Samples contain only
/// sensor readings, no ground truth.
class Bench {
 public:
  Bench(const sensors::SensorTable& table, std::uint64_t seed, const Variety& variety)
      : table_(table), seed_(seed), variety_(variety) {}

  /// All samples of a trial, at the BioTac's rate. Deterministic for a given trial and seed.
  std::vector<Sample> run(const Trial& trial) const;

 private:
  sensors::SensorTable table_;
  std::uint64_t seed_;
  Variety variety_;
};

/// Writes trials in sequence to a file that palpate-train reads. A trial is written completely or
/// not at all.
class CollectionFile {
 public:
  virtual ~CollectionFile() = default;
  virtual void add(const Trial& trial, const std::vector<Sample>& samples) = 0;
  /// Number of trials already in the file.
  virtual int trials() const = 0;
};

/// *.log: an LCM event log of BIOTAC_0 and FT_WRENCH, as a hand sends them, and of a
/// COMPONENT_EVENT at the start of each trial; trials are 2 s apart. Otherwise CSV, one row per
/// reading of the BioTac, with the columns trial, probe, area, profile, t, fx to fz, tx to tz,
/// pac0, pac1, pdc, tac, tdc, e1 to e19. `resume`: appends to an existing CSV. Throws
/// std::runtime_error if the file cannot be written or does not match, std::invalid_argument if a
/// log is to be resumed.
std::unique_ptr<CollectionFile> open_collection(const std::filesystem::path& path, bool resume);

}  // namespace palpate::collect
