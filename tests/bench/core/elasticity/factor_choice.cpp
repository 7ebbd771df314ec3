#include "tests/bench/core/elasticity/factor_choice.hpp"

#include <stdexcept>

#ifdef PALPATE_SUITESPARSE
#include "core/factor/cholmod/cholmod_factor.hpp"
#endif

namespace palpate::bench {

factor::FactorMaker factor_maker(const std::string& name) {
  if (name == "own") return factor::make_own_factor;
#ifdef PALPATE_SUITESPARSE
  if (name == "cholmod") return factor::make_cholmod_factor;
#endif
  throw std::invalid_argument("factor \"" + name +
                              "\": allowed: own, and cholmod in a build with SuiteSparse");
}

}  // namespace palpate::bench
