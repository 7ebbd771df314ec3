#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>

#include "core/math/column_factor.hpp"

namespace palpate::math {

/// How a row of a quadratic program is meant. Level 0 is hard: it holds or the program is
/// infeasible. Rows of levels 1 to 3 may give way: first those of level 3, then 2, then 1; within a
/// level the row of the smaller weight.
struct RowPriority {
  static constexpr int kSoftest = 3;
  int level = 0;      // 0 to kSoftest
  double weight = 1;  // above 0, of order 1; of no effect at level 0
};

/// min 1/2 u^T H u + g^T u  subject to  lower <= a_i^T u <= upper  for each row i, some of which
/// may give way. Units are the caller's. Filled anew each cycle without allocating:
///
///   QuadraticProgram program(6);
///   program.H = ...; program.g = ...;         // H positive definite; its lower triangle is read
///   program.clear_rows();
///   program.add_bound(0, -0.1, 0.1);          // a limit on one variable
///   program.add_row(J.row(2), low, high, {2, 1.0});
///
/// Rows are told apart by their order alone, so for a warm start the same limit must be the same
/// row in each cycle; a limit that is not wanted now stays as a row with infinite bounds.
struct QuadraticProgram {
  static constexpr int kMostVariables = ColumnFactor::kMost;
  static constexpr int kMostRows = 144;
  static constexpr double kNoBound = std::numeric_limits<double>::infinity();

  /// H = 0, g = 0, no rows. Throws std::invalid_argument unless 1 <= variables <= kMostVariables.
  explicit QuadraticProgram(int variables);

  int variables() const noexcept { return static_cast<int>(g.size()); }
  int rows() const noexcept { return row_count; }
  void clear_rows() noexcept { row_count = 0; }

  /// Adds lower <= a^T u <= upper, equal for an equation, -kNoBound or kNoBound where there is no
  /// limit. `a` holds variables() numbers, as row or column; a product of matrices given for it
  /// would allocate. Its index, or -1 where kMostRows are there already.
  template <class Vector>
  int add_row(const Eigen::MatrixBase<Vector>& a, double lower, double upper,
              const RowPriority& priority = {}) noexcept {
    if (row_count == kMostRows) return -1;
    for (int k = 0; k < variables(); ++k) A(k, row_count) = a.derived().coeff(k);
    bounds[row_count] = {lower, upper, priority};
    return row_count++;
  }
  /// Adds lower <= u_variable <= upper.
  int add_bound(int variable, double lower, double upper,
                const RowPriority& priority = {}) noexcept {
    return add_row(ColumnFactor::Vector::Unit(variables(), variable), lower, upper, priority);
  }

  struct Bounds {
    double lower = 0;
    double upper = 0;
    RowPriority priority;
  };

  ColumnFactor::Matrix H;
  ColumnFactor::Vector g;
  int row_count = 0;
  std::array<Bounds, kMostRows> bounds;
  /// Column i is a_i: variables() x kMostRows.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMostVariables, kMostRows>
      A;
};

/// Solver of small dense quadratic programs: the dual active-set method of Goldfarb and Idnani
/// (1983) with bounded multipliers and a warm start. It fits here because it starts from the
/// unconstrained optimum, which in a servo loop breaks few limits, needs no feasible point, proves
/// infeasibility, and every iterate is the optimum of the limits looked at so far.
///
/// Soft rows are exact penalties: a row that gives way costs `price` for each unit by which it is
/// broken, so its multiplier is bounded by the price, and that bound is all that the solver has
/// to know: there are no slack variables, the program stays as small and as well-conditioned, and
/// soft rows that can hold without a multiplier beyond the price hold exactly. In units of H (row
/// i's value divided by (a_i^T H^-1 a_i)^1/2) the prices of levels 1, 2, 3 are 1e6, 1e4, 1e2 times
/// the distance from the unconstrained optimum to 0 and to the worst row, times the weight. So a
/// level gives way before the next one unless it buys that one less than a hundredth of its own
/// violation. A sequence of programs, one a level, would have no such exception, but would cost
/// several solves in the very cycles where limits conflict.
class QuadraticProgramSolver {
 public:
  using Vector = ColumnFactor::Vector;
  using RowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, QuadraticProgram::kMostRows, 1>;

  enum class Status {
    kOptimal,
    kInfeasible,      // no u meets the hard rows; multipliers() proves it
    kIterationLimit,  // u() is optimal for some of the rows only
    kNotFinite,       // a number is not finite, or a level or weight is not allowed
    kNotConvex        // H is not positive definite
  };
  enum class Start { kWarm, kCold };

  /// Relative to the scale that prices use: what counts as broken.
  static constexpr double kTolerance = 1e-10;
  static constexpr int kMostIterations = 600;

  /// kWarm starts from the rows that were active in the last optimum, where that had as many
  /// variables and rows, else as kCold; the answer is the same. Only the numbers of kOptimal may be
  /// used for motion. With l > u an equation is meant where they differ by rounding; else a hard
  /// row is infeasible, a soft one gives way evenly.
  Status solve(const QuadraticProgram& program, Start start = Start::kWarm) noexcept;

  /// The next solve starts cold.
  void reset() noexcept { last_rows_ = -1; }

  const Vector& u() const noexcept { return u_; }

  /// One a row, H u + g + sum_i multiplier_i a_i = 0: above 0 where the row presses at its upper
  /// bound, below 0 at its lower. After kInfeasible a proof of it, greatest entry 1: sum_i
  /// multiplier_i a_i = 0 while sum_i multiplier_i bound_i < 0, with the bound of the side that the
  /// sign tells; all zero where one row's bounds contradict each other.
  const RowVector& multipliers() const noexcept { return multipliers_; }

  /// One a row, in its units: above 0 by how much a_i^T u exceeds the upper bound, below 0 by how
  /// much it falls short of the lower one; 0 where the row holds to within kTolerance.
  const RowVector& violations() const noexcept { return violations_; }

  /// Largest |violation| among the rows of one level.
  double worst_violation(const QuadraticProgram& program, int level) const noexcept;

  int iterations() const noexcept { return iterations_; }

 private:
  enum class State : signed char { kBelow = -1, kFree = 0, kAbove = 1, kActive = 2 };
  struct Row {
    double lower, upper;  // of n^T y
    double norm;          // of L^-1 a
    double price;         // bound of |multiplier|
    double multiplier;
    State state;  // kBelow, kAbove: gives way, the multiplier is at its bound
    bool at_upper;
    double least() const noexcept;  // bounds of the multiplier while the row is on its side
    double greatest() const noexcept;
  };

  bool is_valid(const QuadraticProgram& program) const noexcept;
  bool scale(const QuadraticProgram& program) noexcept;
  bool set_bounds(const QuadraticProgram& program) noexcept;
  void price(const QuadraticProgram& program) noexcept;
  void take_active_rows() noexcept;
  Status iterate() noexcept;
  int most_broken(double& sign) const noexcept;
  Status settle(int row, double sign) noexcept;
  void set_ray(int row, double sign, const Vector& follow) noexcept;
  void leave(int position) noexcept;
  void release(Row& row) noexcept;
  void project() noexcept;
  void update_values() noexcept;
  void publish(const QuadraticProgram& program) noexcept;

  int n_ = 0;
  int m_ = 0;
  int last_variables_ = -1;
  int last_rows_ = -1;
  int iterations_ = 0;
  double scale_ = 0;
  double tolerance_ = 0;
  // y = L^T u with H = L L^T, so that the program is to project y0 onto the rows N^T y.
  ColumnFactor::Matrix L_;
  decltype(QuadraticProgram::A) N_;  // unit columns
  Vector y0_, y_, normal_, inside_, outside_;
  RowVector values_;  // N^T y
  std::array<Row, QuadraticProgram::kMostRows> row_;
  ColumnFactor factor_;
  std::array<int, QuadraticProgram::kMostVariables> active_{};  // rows, as columns of factor_
  Vector u_;
  RowVector multipliers_, violations_;
};

}  // namespace palpate::math
