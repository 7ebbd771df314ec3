#pragma once

#include <string>
#include <vector>

namespace palpate::fit {

/// What a number measures, which says the units that it may have.
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

/// How the dimension is called ("force").
std::string name_of(Dimension dimension);

/// The unit in which a dimension's numbers are kept ("N"; "" for a ratio).
const char* si_unit(Dimension dimension);

/// Every unit that the dimension may have, the SI one first.
std::vector<std::string> units_of(Dimension dimension);

/// What a number in `unit` has to be multiplied with to be in SI; 0 where the dimension knows no
/// such unit.
double si_factor(Dimension dimension, const std::string& unit);

}  // namespace palpate::fit
