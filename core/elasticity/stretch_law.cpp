#include "core/elasticity/stretch_law.hpp"

namespace palpate::elasticity {
namespace {

constexpr double kLowestExponent = -40, kHighestExponent = 60, kLargestShare = 5;

NamedStretchLaw::Constant exponent_constant(const std::string& name, const std::string& of,
                                            double start) {
  return {name, "Exponent of the principal stretches in " + of, start, kLowestExponent,
          kHighestExponent};
}

NamedStretchLaw::Constant share_constant(const std::string& name, const std::string& of) {
  return {name, "Share of the shear modulus that belongs to " + of, 0.3, -kLargestShare,
          kLargestShare};
}

}  // namespace

const std::vector<NamedStretchLaw>& stretch_laws() {
  using Values = std::vector<double>;
  static const std::vector<NamedStretchLaw> all{
      {"neo_hookean", "Neo-Hookean law", {}, 0, [](const Values&) { return StretchLaw(); }},
      {"mooney_rivlin",
       "Mooney-Rivlin law",
       {share_constant("mooney_share", "the second invariant of the Mooney-Rivlin law")},
       0,
       [](const Values& c) {
         return StretchLaw{1, {2, 2}, {1 - c[0], 0}, c[0]};
       }},
      {"ogden_1",
       "Ogden's law with one term",
       {exponent_constant("ogden_exponent", "Ogden's law", 2)},
       1,
       [](const Values& c) {
         return StretchLaw{1, {c[0], 2}, {1, 0}, 0};
       }},
      {"ogden_2",
       "Ogden's law with two terms",
       {exponent_constant("ogden_exponent", "Ogden's law", 2),
        exponent_constant("ogden_exponent_2", "the second term of Ogden's law", -2),
        share_constant("ogden_share_2", "the second term of Ogden's law")},
       2,
       [](const Values& c) {
         return StretchLaw{2, {c[0], c[1]}, {1 - c[2], c[2]}, 0};
       }}};
  return all;
}

const NamedStretchLaw* find_stretch_law(const std::string& name) {
  for (const NamedStretchLaw& law : stretch_laws())
    if (law.name == name) return &law;
  return nullptr;
}

}  // namespace palpate::elasticity
