#pragma once

#include <string>
#include <vector>

namespace palpate::fit {

/// Dimension of a number, which determines the units that it may have.
enum class Dimension {
  kForce,
  kTorque,
  kStress,
  kLength,
  kArea,
  kStrain,
  kAngle,
  kMass,
  kDensity,
  kTime,
  kFrequency,
  kVelocity,
  kAcceleration,
  kRatio,
};

/// Name of the dimension ("force").
std::string name_of(Dimension dimension);

/// The unit in which a dimension's numbers are stored ("N"; "" for a ratio).
const char* si_unit(Dimension dimension);

/// Every unit that the dimension may have, the SI one first.
std::vector<std::string> units_of(Dimension dimension);

/// Factor from `unit` to SI; 0 if the dimension has no such unit.
double si_factor(Dimension dimension, const std::string& unit);

}  // namespace palpate::fit
