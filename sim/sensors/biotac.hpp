#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/math/random.hpp"
#include "core/sensing/biotac_geometry.hpp"
#include "sim/sensors/biotac_skin.hpp"
#include "sim/sensors/sensor_table.hpp"

namespace palpate::sensors {

/// Radius (m) of a circle of this area (m^2).
double radius_of(double area);

/// Counts of an electrode that reads `rest` at rest, for its `resistance` relative to rest: across
/// a voltage divider, where counts rise (polarity 1) or fall (-1) as the fluid film thins.
double electrode_counts(double rest, double resistance, double polarity);

/// Counts that a pressure (Pa) adds to PDC.
double pressure_counts(double pressure);

inline constexpr int kVibrationSamples = 22;  // per BioTac reading, at 2.2 kHz

/// One reading in 12-bit counts.
struct BiotacReading {
  std::int64_t time_us = 0;
  std::array<std::int16_t, sensing::kElectrodeCount> electrodes{};
  std::array<std::int16_t, kVibrationSamples> pac{};
  std::int16_t pdc = 0, tac = 0, tdc = 0;
};

/// Emulated BioTac fingertip (Wettels et al. 2008; Lin, Fishel and Loeb 2013): a skin over a layer
/// of conductive fluid over a core with 19 electrodes. Contacts dent the skin (BiotacSkin); the
/// resistance from an electrode to the excitation electrodes follows the fluid depth along the
/// current path (BiotacFilm) and is read across a divider. The fluid carries the sum of normal
/// forces as a pressure; PAC is its part above 10 Hz. The sensor drifts while it warms up.
/// Parameters are those of the foam recording in reference/sensors.md.
class Biotac {
 public:
  /// `period`: s between readings.
  Biotac(const BiotacTable& table, double period, const math::Random& random);

  /// Advances by `dt` s under these contacts.
  void step(double dt, const std::vector<Touch>& touches);

  /// Current output of the electronics; consumes the vibration since the last reading.
  BiotacReading read();

 private:
  double noisy(const Faults& faults, double& walk);

  BiotacTable table_;
  double period_;
  math::Random random_;
  BiotacSkin skin_;
  sensing::ElectrodeVector rest_;                                         // counts
  sensing::ElectrodeVector walk_ = sensing::ElectrodeVector::Zero();      // counts
  double rest_pressure_, rest_temperature_;                               // counts
  double pressure_ = 0, slow_pressure_ = 0;                               // Pa
  double pressure_walk_ = 0, vibration_walk_ = 0, temperature_walk_ = 0;  // counts
  double time_ = 0;                                                       // s
  std::vector<double> vibration_;  // Pa, one per step since the last reading
};

}  // namespace palpate::sensors
