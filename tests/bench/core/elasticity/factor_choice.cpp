#include "tests/bench/core/elasticity/factor_choice.hpp"

#include <stdexcept>

#ifdef PALPATE_SUITESPARSE
#include "core/factor/cholmod/cholmod_factor.hpp"
#include "core/factor/cholmod/cholmod_orders.hpp"
#endif

namespace palpate::bench {

void choose_factor(const std::string& name, elasticity::SolverOptions& solver) {
  if (name == "own") return;
#ifdef PALPATE_SUITESPARSE
  if (name == "cholmod") {
    solver.make_factor = factor::make_cholmod_factor;
    solver.orders = factor::cholmod_orders;
    return;
  }
#endif
  throw std::invalid_argument("factor \"" + name +
                              "\": allowed: own, and cholmod in a build with SuiteSparse");
}

}  // namespace palpate::bench
