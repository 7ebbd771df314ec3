#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>

namespace palpate::math {

/// Thin factorisation N = Q R of up to kMost columns of length at most kMost; columns are added and
/// removed one at a time by Gram-Schmidt with reorthogonalisation, which keeps Q orthogonal to
/// rounding (Daniel, Gragg, Kaufman and Stewart 1976). Never allocates.
class ColumnFactor {
 public:
  static constexpr int kMost = 16;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;

  /// Removes all columns; new ones have length `length`, 1 to kMost.
  void clear(int length) noexcept;
  int count() const noexcept { return count_; }

  /// column = Q inside + outside with Q^T outside = 0. outside is exactly zero if Q is square.
  void split(const Vector& column, Vector& inside, Vector& outside) const noexcept;

  /// Appends the column decomposed by split(); its part `outside` must not vanish.
  void append(const Vector& inside, const Vector& outside) noexcept;

  /// Removes column `index`; those after it move up.
  void remove(int index) noexcept;

  /// x <- R^-1 x and x <- R^-T x, length count().
  void solve(Vector& x) const noexcept;
  void solve_transposed(Vector& x) const noexcept;

  /// Q, length x count().
  auto basis() const noexcept { return Q_.leftCols(count_); }

 private:
  int length_ = 1;
  int count_ = 0;
  Matrix Q_ = Matrix::Zero(kMost, kMost);
  Matrix R_ = Matrix::Zero(kMost, kMost);
};

/// Priority of a row of a quadratic program. Level 0 is hard: it holds or the program is
/// infeasible. Rows of levels 1 to 3 are soft and are relaxed if necessary: first level 3, then 2,
/// then 1; within a level the row with the smaller weight.
struct RowPriority {
  static constexpr int kSoftest = 3;
  int level = 0;      // 0 to kSoftest
  double weight = 1;  // > 0, of order 1; no effect at level 0
};

/// Quadratic program: min 1/2 u^T H u + g^T u  subject to  lower <= a_i^T u <= upper  for each row
/// i, some of which may be soft. Units are the caller's. Refilled each cycle without allocation:
///
///   QuadraticProgram program(6);
///   program.H = ...; program.g = ...;         // H positive definite; its lower triangle is read
///   program.clear_rows();
///   program.add_bound(0, -0.1, 0.1);          // a limit on one variable
///   program.add_row(J.row(2), low, high, {2, 1.0});
///
/// Rows are identified by their index only: for a warm start a limit must occupy the same row in
/// each cycle. A limit that is inactive in this cycle remains as a row with infinite bounds.
struct QuadraticProgram {
  static constexpr int kMostVariables = ColumnFactor::kMost;
  static constexpr int kMostRows = 160;
  static constexpr double kNoBound = std::numeric_limits<double>::infinity();

  /// H = 0, g = 0, no rows. Throws std::invalid_argument unless 1 <= variables <= kMostVariables.
  explicit QuadraticProgram(int variables);

  int variables() const noexcept { return static_cast<int>(g.size()); }
  int rows() const noexcept { return row_count; }
  void clear_rows() noexcept { row_count = 0; }

  /// Adds lower <= a^T u <= upper; equal bounds make an equation, -kNoBound or kNoBound no limit.
  /// `a`: variables() numbers, row or column; an unevaluated matrix product would allocate. Returns
  /// the row's index, or -1 if kMostRows rows exist already.
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

/// Solver of small dense quadratic programs: dual active-set method of Goldfarb and Idnani (1983)
/// with bounded multipliers and a warm start. It starts from the unconstrained optimum, which in a
/// servo loop violates few limits, needs no feasible point, proves infeasibility, and every iterate
/// is the optimum of the limits considered so far.
///
/// Soft rows are exact penalties: a violated row costs `price` per unit of violation, so its
/// multiplier is bounded by the price. The solver needs no slack variables, the program keeps its
/// size and conditioning, and soft rows that can hold with a multiplier below the price hold
/// exactly. In units of H (row i's value divided by (a_i^T H^-1 a_i)^1/2) the prices of levels 1,
/// 2, 3 are 1e6, 1e4, 1e2 times the distance from the unconstrained optimum to 0 and to the worst
/// row, times the weight. A level is therefore relaxed before the next more important one unless it
/// would reduce that one's violation by less than a hundredth of its own. A sequence of programs,
/// one per level, would have no such exception, but would cost several solves in exactly those
/// cycles in which limits conflict.
class QuadraticProgramSolver {
 public:
  using Vector = ColumnFactor::Vector;
  using RowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, QuadraticProgram::kMostRows, 1>;

  enum class Status {
    kOptimal,
    kInfeasible,      // no u satisfies the hard rows; multipliers() proves it
    kIterationLimit,  // u() is optimal for a subset of the rows
    kNotFinite,       // a number is not finite, or a level or weight is invalid
    kNotConvex        // H is not positive definite
  };
  enum class Start { kWarm, kCold };

  /// Tolerance of a violation, relative to the scale of the prices.
  static constexpr double kTolerance = 1e-10;
  static constexpr int kMostIterations = 600;

  /// kWarm starts from the active rows of the last optimum, if that had as many variables and rows,
  /// else as kCold; the result is the same. Only results with status kOptimal may be used for
  /// motion. Bounds with l > u: an equation if they differ only by rounding; otherwise a hard row
  /// is infeasible, and a soft one is violated on both sides.
  Status solve(const QuadraticProgram& program, Start start = Start::kWarm) noexcept;

  /// The next solve is a cold start.
  void reset() noexcept { last_rows_ = -1; }

  const Vector& u() const noexcept { return u_; }

  /// One per row, H u + g + sum_i multiplier_i a_i = 0: positive if the upper bound is active,
  /// negative if the lower. After kInfeasible a certificate, largest entry 1: sum_i multiplier_i
  /// a_i = 0 while sum_i multiplier_i bound_i < 0, with the bound selected by the sign; all zero if
  /// the bounds of a single row contradict each other.
  const RowVector& multipliers() const noexcept { return multipliers_; }

  /// One per row, in its units: positive by how much a_i^T u exceeds the upper bound, negative by
  /// how much it falls below the lower one; 0 if the row holds to within kTolerance.
  const RowVector& violations() const noexcept { return violations_; }

  /// Largest |violation| among the rows of one level.
  double worst_violation(const QuadraticProgram& program, int level) const noexcept;

  int iterations() const noexcept { return iterations_; }

 private:
  enum class State : signed char { kBelow = -1, kFree = 0, kAbove = 1, kActive = 2 };
  struct Row {
    double lower, upper;  // bounds of n^T y
    double norm;          // norm of L^-1 a
    double price;         // bound of |multiplier|
    double multiplier;
    State state;  // kBelow, kAbove: relaxed, the multiplier is at its bound
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
  // y = L^T u with H = L L^T: the program becomes the projection of y0 onto the rows N^T y.
  ColumnFactor::Matrix L_;
  decltype(QuadraticProgram::A) N_;  // unit columns
  Vector y0_, y_, normal_, inside_, outside_;
  RowVector values_;  // N^T y
  std::array<Row, QuadraticProgram::kMostRows> row_;
  ColumnFactor factor_;
  std::array<int, QuadraticProgram::kMostVariables> active_{};  // rows that are columns of factor_
  Vector u_;
  RowVector multipliers_, violations_;
};

}  // namespace palpate::math
