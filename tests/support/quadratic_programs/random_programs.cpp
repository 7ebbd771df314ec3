#include "tests/support/quadratic_programs/random_programs.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::support {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using math::QuadraticProgram;
using math::Random;
constexpr double kNoBound = QuadraticProgram::kNoBound;

/// On a grid of 2^-8, so that products and sums of a few are exact, and therefore the statements
/// about coincident or contradictory rows.
double on_grid(double value) { return std::round(256 * value) / 256; }

VectorXd normal(int size, Random& random) {
  return VectorXd::NullaryExpr(size, [&](Eigen::Index) { return on_grid(random.normal()); });
}

int between(int least, int most, Random& random) {
  return least + static_cast<int>(random.below(static_cast<std::uint64_t>(most - least + 1)));
}

/// Convex, with an unconstrained optimum about ten units from the origin.
QuadraticProgram free_program(int n, Random& random) {
  QuadraticProgram program(n);
  MatrixXd M(n, n);
  for (int i = 0; i < n; ++i) M.col(i) = normal(n, random);
  program.H = M * M.transpose() / n + random.uniform(0.01, 1) * MatrixXd::Identity(n, n);
  program.g = -program.H * (10 * normal(n, random));
  return program;
}

/// One side or both, some distance from the value at `inside`.
void add_around(QuadraticProgram& program, const VectorXd& a, const VectorXd& inside,
                Random& random) {
  const double value = a.dot(inside);
  const double below = random.uniform(0, 2);
  const double above = random.uniform(0, 2);
  const std::uint64_t sides = random.below(3);
  program.add_row(a, sides == 0 ? -kNoBound : value - below, sides == 1 ? kNoBound : value + above);
}

void add_combination(QuadraticProgram& program, const VectorXd& inside, Random& random) {
  const int rows = program.rows();
  VectorXd a = VectorXd::Zero(program.variables());
  const int terms = between(1, 3, random);
  for (int t = 0; t < terms; ++t) {
    a += on_grid(random.uniform(-2, 2)) * program.A.col(between(0, rows - 1, random));
  }
  add_around(program, a, inside, random);
}

/// Rows whose weighted normals sum to zero while their bounds are contradictory.
void add_contradiction(QuadraticProgram& program, const VectorXd& inside, double gap,
                       Random& random) {
  const int n = program.variables();
  const int terms = between(1, std::min(n, 4), random);
  VectorXd sum = VectorXd::Zero(n);
  double bound = 0;
  for (int t = 0; t < terms; ++t) {
    const VectorXd a = normal(n, random);
    const double upper = a.dot(inside) + on_grid(random.uniform(0, 1));
    const double weight = on_grid(random.uniform(0.2, 2));
    program.add_row(a, -kNoBound, upper);
    sum += weight * a;
    bound += weight * upper;
  }
  program.add_row(sum, bound + gap * (1 + std::abs(bound)), kNoBound);
}

void scale_badly(QuadraticProgram& program, Random& random) {
  const auto factor = [&](double decades) {
    return std::pow(10, random.uniform(-decades, decades));
  };
  for (int k = 0; k < program.variables(); ++k) {
    const double scale = factor(3);
    program.H.row(k) *= scale;
    program.H.col(k) *= scale;
    program.g[k] *= scale;
    program.A.row(k) *= scale;
  }
  for (int i = 0; i < program.rows(); ++i) {
    const double scale = factor(6);
    program.A.col(i) *= scale;
    program.bounds[i].lower *= scale;
    program.bounds[i].upper *= scale;
  }
}

/// Half of the rows are active at the optimum, all pass through it.
void make_vertex(QuadraticProgram& program, int rows, Random& random) {
  const VectorXd optimum = normal(program.variables(), random);
  program.g = -program.H * optimum;
  for (int i = 0; i < rows; ++i) {
    const VectorXd a = normal(program.variables(), random);
    program.add_row(a, -kNoBound, a.dot(optimum));
    if (i % 2 == 0) program.g -= random.uniform(0, 1) * a;
  }
}

void add_soft_rows(QuadraticProgram& program, int rows, Random& random) {
  for (int i = 0; i < rows; ++i) {
    const VectorXd a = normal(program.variables(), random);
    const double middle = random.uniform(-20, 20);
    const double width = random.below(4) == 0 ? 0 : random.uniform(0, 3);
    const std::uint64_t sides = random.below(3);
    program.add_row(a, sides == 0 ? -kNoBound : middle - width,
                    sides == 1 ? kNoBound : middle + width,
                    {between(1, math::RowPriority::kSoftest, random), random.uniform(0.5, 2)});
  }
}

}  // namespace

std::string name(Family family) {
  constexpr const char* kNames[kFamilies] = {"plain",     "box",  "redundant",  "equations",
                                             "deficient", "thin", "infeasible", "badly_scaled",
                                             "vertex",    "soft"};
  return kNames[static_cast<int>(family)];
}

QuadraticProgram random_program(Family family, int variables, int rows, Random& random) {
  const int n = between(1, variables, random);
  const int m = between(1, rows, random);
  QuadraticProgram program = free_program(n, random);
  const VectorXd inside = normal(n, random);
  const auto add_plain = [&](int count) {
    for (int i = 0; i < count; ++i) add_around(program, normal(n, random), inside, random);
  };
  switch (family) {
    case Family::kPlain:
      add_plain(m);
      break;
    case Family::kBox:
      for (int k = 0; k < n; ++k) {
        program.add_bound(k, inside[k] - random.uniform(0, 2), inside[k] + random.uniform(0, 2));
      }
      add_plain(std::max(0, m - n));
      break;
    case Family::kRedundant:
      add_plain(1 + m / 3);
      while (program.rows() < m) add_combination(program, inside, random);
      break;
    case Family::kEquations: {
      const int equations = between(1, n, random);
      for (int i = 0; i < equations; ++i) {
        const VectorXd a = normal(n, random);
        program.add_row(a, a.dot(inside), a.dot(inside));
        if (random.below(2) == 0) program.add_row(-2 * a, -2 * a.dot(inside), -2 * a.dot(inside));
      }
      add_plain(std::max(0, m - program.rows()));
      break;
    }
    case Family::kRankDeficient: {
      const int rank = between(1, std::min(3, n), random);
      MatrixXd span(n, rank);
      for (int k = 0; k < rank; ++k) span.col(k) = normal(n, random);
      for (int i = 0; i < m; ++i) add_around(program, span * normal(rank, random), inside, random);
      break;
    }
    case Family::kThin: {
      const VectorXd a = normal(n, random);
      const double scale = on_grid(random.uniform(0.5, 2));
      const double width = 1e-6 * (1 + std::abs(a.dot(inside)));
      program.add_row(a, -kNoBound, a.dot(inside) + width);
      program.add_row(-scale * a, -kNoBound, -scale * (a.dot(inside) - width));
      add_plain(std::max(0, m - 2));
      break;
    }
    case Family::kInfeasible:
      add_plain(std::max(0, m - 5));
      add_contradiction(program, inside, std::pow(10, random.uniform(-6, 0)), random);
      break;
    case Family::kBadlyScaled:
      add_plain(m);
      scale_badly(program, random);
      break;
    case Family::kVertex:
      make_vertex(program, m, random);
      break;
    case Family::kSoft:
      for (int k = 0; k < n; ++k) program.add_bound(k, -15, 15);
      add_soft_rows(program, std::max(1, m - n), random);
      break;
  }
  return program;
}

void drift(QuadraticProgram& program, double size, Random& random) {
  for (int k = 0; k < program.variables(); ++k) program.g[k] *= 1 + size * random.normal();
  for (int i = 0; i < program.rows(); ++i) {
    QuadraticProgram::Bounds& bounds = program.bounds[i];
    if (bounds.lower == bounds.upper) continue;
    bounds.lower -= std::abs(size * random.normal() * bounds.lower);
    bounds.upper += std::abs(size * random.normal() * bounds.upper);
  }
}

}  // namespace palpate::support
