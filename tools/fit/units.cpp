#include "tools/fit/units.hpp"

#include <utility>

#include "core/math/constants.hpp"

namespace palpate::fit {
namespace {

struct DimensionUnits {
  const char* name;
  std::vector<std::pair<std::string, double>> units;  // the SI unit first
};

const DimensionUnits& table(Dimension dimension) {
  using math::kDegree;
  constexpr double kGravity = 9.80665;  // standard, m/s^2
  // In the order of the enumeration.
  static const std::vector<DimensionUnits> all = {
      {"force", {{"N", 1}, {"mN", 1e-3}, {"kN", 1e3}, {"gf", 1e-3 * kGravity}, {"kgf", kGravity}}},
      {"torque", {{"N m", 1}, {"N mm", 1e-3}, {"mN m", 1e-3}}},
      {"stress", {{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"N/mm2", 1e6}, {"bar", 1e5}}},
      {"length", {{"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"um", 1e-6}, {"in", 25.4e-3}}},
      {"area", {{"m2", 1}, {"mm2", 1e-6}, {"cm2", 1e-4}}},
      {"strain", {{"1", 1}, {"%", 1e-2}, {"mm/mm", 1}}},
      {"angle", {{"rad", 1}, {"deg", kDegree}, {"mrad", 1e-3}}},
      {"mass", {{"kg", 1}, {"g", 1e-3}, {"mg", 1e-6}}},
      {"density", {{"kg/m3", 1}, {"g/cm3", 1e3}}},
      {"time", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}}},
      {"frequency", {{"Hz", 1}, {"kHz", 1e3}}},
      {"velocity", {{"m/s", 1}, {"mm/s", 1e-3}, {"mm/min", 1e-3 / 60}}},
      {"acceleration", {{"m/s2", 1}, {"mm/s2", 1e-3}, {"g", kGravity}}},
      {"ratio", {{"", 1}, {"1", 1}, {"%", 1e-2}}},
  };
  return all[static_cast<std::size_t>(dimension)];
}

}  // namespace

std::string name_of(Dimension dimension) { return table(dimension).name; }

const char* si_unit(Dimension dimension) {
  const std::string& unit = table(dimension).units.front().first;
  return unit == "1" ? "" : unit.c_str();
}

std::vector<std::string> units_of(Dimension dimension) {
  std::vector<std::string> units;
  for (const auto& entry : table(dimension).units) units.push_back(entry.first);
  return units;
}

double si_factor(Dimension dimension, const std::string& unit) {
  for (const auto& [name, factor] : table(dimension).units)
    if (name == unit) return factor;
  return 0;
}

}  // namespace palpate::fit
