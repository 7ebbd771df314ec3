#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/math/random.hpp"
#include "core/sensing/biotac_geometry.hpp"
#include "sim/sensors/sensor_table.hpp"

namespace palpate::sensors {

/// Something that presses on a fingertip; T is the frame of core/sensing/biotac_geometry.hpp.
struct Touch {
  Eigen::Vector3d location_T = Eigen::Vector3d::Zero();  // m, on or near the skin
  Eigen::Vector3d force_T = Eigen::Vector3d::Zero();     // N, on the finger
  double radius = 2e-3;                                  // m, of the area of contact
};

/// Radius (m) of a circle of this area (m^2).
double radius_of(double area);

inline constexpr int kVibrationSamples = 22;  // of one BioTac reading, at 2.2 kHz

/// One reading in 12-bit counts.
struct BiotacReading {
  std::int64_t time_us = 0;
  std::array<std::int16_t, sensing::kElectrodeCount> electrodes{};
  std::array<std::int16_t, kVibrationSamples> pac{};
  std::int16_t pdc = 0, tac = 0, tdc = 0;
};

/// Emulated BioTac fingertip (Wettels et al. 2008; Lin, Fishel and Loeb 2013): a skin over a layer
/// of conductive fluid over a core with 19 electrodes. A touch dents the skin as a foundation of
/// springs would give, spread to a bell of the touch's radius and the fluid's depth, dragged along
/// by shear, which shifts the skin about the core; what it displaces lifts the skin elsewhere. The
/// impedance of an electrode follows the logarithm of the depth of fluid above it, part of it late
/// (the skin creeps). The fluid's pressure follows the sum of normal forces, PAC is that above 10
/// Hz. While it warms up the sensor drifts. Sizes are those of the foam and plate recordings in
/// reference/sensors.md.
class Biotac {
 public:
  /// `period`: s between readings.
  Biotac(const BiotacTable& table, double period, const math::Random& random);

  /// `dt` s under these touches.
  void step(double dt, const std::vector<Touch>& touches);

  /// What the electronics give now; takes the vibration since the last reading.
  BiotacReading read();

  /// Depth by which the skin is pressed in above each electrode, m, negative where it bulges:
  /// as in equilibrium with these touches.
  static sensing::ElectrodeVector indentation(const std::vector<Touch>& touches);

 private:
  double noisy(const Faults& faults, double& walk);

  BiotacTable table_;
  double period_;
  math::Random random_;
  sensing::ElectrodeVector rest_;                                                    // counts
  sensing::ElectrodeVector dent_ = sensing::ElectrodeVector::Zero(), late_ = dent_;  // m
  sensing::ElectrodeVector walk_ = dent_;                                            // counts
  double rest_pressure_, rest_temperature_;                                          // counts
  double pressure_ = 0, slow_pressure_ = 0;                                          // Pa
  double pressure_walk_ = 0, vibration_walk_ = 0, temperature_walk_ = 0;             // counts
  double time_ = 0;                                                                  // s
  std::vector<double> vibration_;  // Pa, one for each step since the last reading
};

}  // namespace palpate::sensors
