#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "sim/sensors/biotac_skin.hpp"
#include "sim/sensors/channel.hpp"

namespace palpate::sensors {

/// Contact of one fingertip as a tactile sensor of any kind reports it, in the frame T of
/// core/sensing/biotac_geometry.hpp.
struct FingertipReading {
  std::int64_t time_us = 0;
  bool contact = false;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();   // m, centre of the contact, on the skin
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, outward, there; zero without contact
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N, of the fingertip on the object
  double place_deviation = 0, force_deviation = 0;   // m, N: noise of each coordinate
  double area = 0;                                   // m^2
};

/// Emulated tactile fingertip that reports place, normal and force, with the errors of its table.
class FingertipSensor {
 public:
  /// `period`: s between readings.
  FingertipSensor(const FingertipTable& table, double period, const math::Random& random);

  FingertipReading read(const std::vector<Touch>& touches);

 private:
  FingertipTable table_;
  Signal place_, force_;
};

}  // namespace palpate::sensors
