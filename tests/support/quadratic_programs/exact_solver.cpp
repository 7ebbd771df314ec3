#include "tests/support/quadratic_programs/exact_solver.hpp"

#include <CGAL/Gmpzf.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>

#include <algorithm>
#include <cmath>

#include "tests/support/quadratic_programs/certificate.hpp"

namespace palpate::support {

std::optional<Eigen::VectorXd> exact_answer(const math::QuadraticProgram& program) {
  const int n = program.variables();
  const Scales scales(program);
  CGAL::Quadratic_program<double> exact(CGAL::SMALLER, false, 0, false, 0);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) exact.set_d(i, j, program.H(i, j));  // of twice its matrix D
    exact.set_c(i, program.g[i]);
  }
  int variables = n;
  int rows = 0;
  for (int i = 0; i < program.rows(); ++i) {
    const auto& [given_lower, given_upper, priority] = program.bounds[i];
    const double lower = std::min(given_lower, given_upper);
    const double upper = std::max(given_lower, given_upper);
    const bool soft = priority.level > 0;
    if (soft && scales.norm[i] == 0) continue;  // independent of u
    const auto add = [&](double bound, CGAL::Comparison_result relation) {
      for (int k = 0; k < n; ++k) exact.set_a(k, rows, program.A(k, i));
      exact.set_b(rows, bound);
      exact.set_r(rows, relation);
      // Violation of the upper bound, then of the lower one.
      for (const auto useless : {CGAL::LARGER, CGAL::SMALLER}) {
        if (!soft || relation == useless) continue;
        exact.set_a(variables, rows, useless == CGAL::LARGER ? -1 : 1);
        exact.set_l(variables, true, 0);
        exact.set_c(variables++, scales.price[i]);
      }
      ++rows;
    };
    if (lower == upper) {
      add(upper, CGAL::EQUAL);
      continue;
    }
    if (std::isfinite(upper)) add(upper, CGAL::SMALLER);
    if (std::isfinite(lower)) add(lower, CGAL::LARGER);
  }
  const auto solution = CGAL::solve_quadratic_program(exact, CGAL::Gmpzf());
  if (!solution.is_optimal()) return {};
  Eigen::VectorXd u(n);
  auto value = solution.variable_values_begin();
  for (int k = 0; k < n; ++k, ++value) u[k] = CGAL::to_double(*value);
  return u;
}

}  // namespace palpate::support
