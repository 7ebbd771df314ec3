#pragma once

#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/elasticity/stretch_law.hpp"

namespace palpate::elasticity {

struct TestedLaw {
  std::string name;
  std::vector<double> constants;

  StretchLaw law() const {
    const NamedStretchLaw* found = find_stretch_law(name);
    if (found == nullptr) throw std::invalid_argument("no law " + name);
    return found->make(constants);
  }
};

inline std::ostream& operator<<(std::ostream& out, const TestedLaw& law) { return out << law.name; }

inline const std::vector<TestedLaw>& tested_laws() {
  static const std::vector<TestedLaw> all{{"neo_hookean", {}},
                                          {"mooney_rivlin", {0.3}},
                                          {"ogden_1", {3.3}},
                                          {"ogden_2", {4.1, -2.2, 0.35}}};
  return all;
}

}  // namespace palpate::elasticity
