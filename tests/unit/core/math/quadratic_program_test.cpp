#include "core/math/quadratic_program.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rt/loop/allocation_counter.hpp"
#include "tests/support/quadratic_programs/certificate.hpp"
#include "tests/support/quadratic_programs/exact_solver.hpp"
#include "tests/support/quadratic_programs/random_programs.hpp"

namespace palpate::math {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Solver = QuadraticProgramSolver;
using Start = Solver::Start;
using Status = Solver::Status;
using support::Family;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoBound = QuadraticProgram::kNoBound;

/// The point closest to `wish`.
QuadraticProgram nearest(const VectorXd& wish) {
  QuadraticProgram program(static_cast<int>(wish.size()));
  program.H.setIdentity();
  program.g = -wish;
  return program;
}

TEST(QuadraticProgram, WithoutRowsIsTheUnconstrainedOptimum) {
  QuadraticProgram program(2);
  program.H << 4, 1, 1, 3;
  program.g << 1, 2;
  Solver solver;
  ASSERT_EQ(solver.solve(program), Status::kOptimal);
  EXPECT_LT((program.H * solver.u() + program.g).norm(), 1e-14);
  EXPECT_EQ(solver.iterations(), 0);
}

TEST(QuadraticProgram, ReadsTheLowerTriangleOfH) {
  QuadraticProgram program(2);
  program.H << 4, kNan, 1, 3;
  program.g << 1, 2;
  Solver solver;
  ASSERT_EQ(solver.solve(program), Status::kOptimal);
  EXPECT_LT((solver.u() - Eigen::Vector2d(-1, -7) / 11).norm(), 1e-14);
}

// Nocedal and Wright, Numerical Optimization, example 16.4.
TEST(QuadraticProgram, SolvesATextbookExample) {
  QuadraticProgram program(2);
  program.H = 2 * Eigen::Matrix2d::Identity();
  program.g << -2, -5;
  program.add_row(Eigen::RowVector2d(1, -2), -2, kNoBound);
  program.add_row(Eigen::RowVector2d(-1, -2), -6, kNoBound);
  program.add_row(Eigen::RowVector2d(-1, 2), -2, kNoBound);
  program.add_bound(0, 0, kNoBound);
  program.add_bound(1, 0, kNoBound);
  Solver solver;
  ASSERT_EQ(solver.solve(program), Status::kOptimal);
  EXPECT_LT((solver.u() - Eigen::Vector2d(1.4, 1.7)).norm(), 1e-14);
  EXPECT_NEAR(solver.multipliers()[0], -0.8, 1e-14);  // lower bound: below 0
  EXPECT_EQ(VectorXd(solver.multipliers().tail(4)), VectorXd::Zero(4));
}

TEST(QuadraticProgram, EquationsHoldOnBothSides) {
  QuadraticProgram program = nearest(Eigen::Vector3d(1, 2, 3));
  program.add_row(Eigen::Vector3d(1, 1, 1), 3, 3);
  program.add_row(Eigen::Vector3d(2, 2, 2), 6, 6);  // the same again
  program.add_bound(0, 0.5, 0.5);
  Solver solver;
  ASSERT_EQ(solver.solve(program), Status::kOptimal);
  EXPECT_LT((solver.u() - Eigen::Vector3d(0.5, 0.75, 1.75)).norm(), 1e-14);
}

TEST(QuadraticProgram, ProvesThatHardRowsContradict) {
  QuadraticProgram program = nearest(Eigen::Vector2d(0, 0));
  program.add_row(Eigen::Vector2d(1, 1), 2, kNoBound);
  program.add_bound(0, -kNoBound, 0.5);
  program.add_bound(1, -kNoBound, 1);
  Solver solver;
  ASSERT_EQ(solver.solve(program), Status::kInfeasible);
  EXPECT_TRUE(support::proves_infeasibility(program, solver));
  EXPECT_LT((solver.multipliers() - Eigen::Vector3d(-1, 1, 1)).norm(), 1e-14);
}

TEST(QuadraticProgram, RefusesRowsThatContradictThemselves) {
  Solver solver;
  QuadraticProgram crossed = nearest(Eigen::Vector2d(0, 0));
  crossed.add_bound(0, 1, 0.5);
  EXPECT_EQ(solver.solve(crossed), Status::kInfeasible);
  crossed.bounds[0].upper = 1 - 1e-15;  // by rounding only
  ASSERT_EQ(solver.solve(crossed), Status::kOptimal);
  EXPECT_NEAR(solver.u()[0], 1, 1e-14);

  QuadraticProgram empty = nearest(Eigen::Vector2d(0, 0));
  empty.add_row(Eigen::Vector2d(0, 0), -1, 1);
  EXPECT_EQ(solver.solve(empty), Status::kOptimal);
  empty.bounds[0].lower = 0.5;
  EXPECT_EQ(solver.solve(empty), Status::kInfeasible);
  empty.bounds[0].priority.level = 1;
  ASSERT_EQ(solver.solve(empty), Status::kOptimal);
  EXPECT_EQ(solver.violations()[0], -0.5);
}

TEST(QuadraticProgram, RefusesNumbersThatAreNone) {
  Solver solver;
  QuadraticProgram good = nearest(Eigen::Vector2d(1, 0));
  good.add_bound(0, -kNoBound, kNoBound);
  ASSERT_EQ(solver.solve(good), Status::kOptimal);
  const auto expect_refused = [&](auto&& spoil, Status status) {
    QuadraticProgram bad = good;
    spoil(bad);
    EXPECT_EQ(solver.solve(bad), status);
    EXPECT_EQ(solver.u(), Eigen::Vector2d(0, 0));
    EXPECT_EQ(solver.solve(good), Status::kOptimal);
  };
  expect_refused([](auto& p) { p.H(1, 0) = kNan; }, Status::kNotFinite);
  expect_refused([](auto& p) { p.g[1] = kNoBound; }, Status::kNotFinite);
  expect_refused([](auto& p) { p.A(0, 0) = kNan; }, Status::kNotFinite);
  expect_refused([](auto& p) { p.bounds[0].lower = kNan; }, Status::kNotFinite);
  expect_refused([](auto& p) { p.bounds[0].lower = kNoBound; }, Status::kNotFinite);
  expect_refused([](auto& p) { p.bounds[0].priority = {4, 1}; }, Status::kNotFinite);
  expect_refused([](auto& p) { p.bounds[0].priority = {1, 0}; }, Status::kNotFinite);
  expect_refused([](auto& p) { p.H(1, 1) = 0; }, Status::kNotConvex);
  EXPECT_THROW(QuadraticProgram(0), std::invalid_argument);
  EXPECT_THROW(QuadraticProgram(17), std::invalid_argument);
}

TEST(QuadraticProgram, HoldsItsMostRowsAndNoMore) {
  QuadraticProgram program = nearest(Eigen::Vector2d(3, 4));
  for (int i = 0; i < QuadraticProgram::kMostRows; ++i) {
    const double angle = 2 * M_PI * i / QuadraticProgram::kMostRows;
    EXPECT_EQ(program.add_row(Eigen::Vector2d(std::cos(angle), std::sin(angle)), -kNoBound, 1), i);
  }
  EXPECT_EQ(program.add_bound(0, 0, 0), -1);
  Solver solver;
  ASSERT_EQ(solver.solve(program), Status::kOptimal);
  EXPECT_LT(support::optimality_error(program, solver).largest(), 1e-13);
  EXPECT_NEAR(solver.u().norm(), 1, 1e-3);  // the rows draw a circle
}

TEST(SoftRows, HoldExactlyWhereTheyCan) {
  QuadraticProgram hard = nearest(Eigen::Vector3d(3, -2, 5));
  QuadraticProgram soft = hard;
  int level = 0;
  for (QuadraticProgram* program : {&hard, &soft}) {
    program->add_row(Eigen::Vector3d(1, 1, 1), -1, 1, {level, 1});
    program->add_bound(2, -2, 2, {level, 1});
    program->add_row(Eigen::Vector3d(1, -1, 0), 0, 0, {level, 1});
    level = RowPriority::kSoftest;
  }
  Solver a, b;
  ASSERT_EQ(a.solve(hard), Status::kOptimal);
  ASSERT_EQ(b.solve(soft), Status::kOptimal);
  EXPECT_LT((a.u() - b.u()).norm(), 1e-13);
  EXPECT_EQ(b.worst_violation(soft, RowPriority::kSoftest), 0);
}

/// Rows that require u_0 to be the index of their level, times 10: levels 1, 2, 3.
TEST(SoftRows, GiveWayInTheirOrder) {
  for (int absent = 1; absent <= 4; ++absent) {
    QuadraticProgram program = nearest(Eigen::Vector2d(0, 1));
    program.add_bound(0, -25, 25);
    for (int level = RowPriority::kSoftest; level >= 1; --level) {
      if (level == absent) continue;
      program.add_bound(0, 10 * level, 10 * level, {level, level == 1 ? 0.3 : 3.0});
    }
    Solver solver;
    ASSERT_EQ(solver.solve(program), Status::kOptimal);
    const int first = absent == 1 ? 2 : 1;
    EXPECT_NEAR(solver.u()[0], 10 * first, 1e-9);
    EXPECT_NEAR(solver.u()[1], 1, 1e-14);
    EXPECT_EQ(solver.worst_violation(program, 0), 0);
    EXPECT_EQ(solver.worst_violation(program, first), 0);
    const int last = absent == 3 ? 2 : 3;
    EXPECT_NEAR(solver.worst_violation(program, last), 10 * (last - first), 1e-9);
  }
}

TEST(SoftRows, GiveWayToHardOnesAndByWeightAmongThemselves) {
  QuadraticProgram program = nearest(Eigen::Vector2d(0, 0));
  program.add_bound(0, 2, kNoBound, {2, 1.0});
  program.add_bound(0, -kNoBound, -2, {2, 1.5});
  program.add_bound(1, 3, kNoBound, {1, 1.0});
  program.add_bound(1, -kNoBound, 1);
  Solver solver;
  ASSERT_EQ(solver.solve(program), Status::kOptimal);
  EXPECT_NEAR(solver.u()[0], -2, 1e-9);
  EXPECT_NEAR(solver.u()[1], 1, 1e-12);
  EXPECT_NEAR(solver.violations()[0], -4, 1e-9);
  EXPECT_EQ(solver.violations()[1], 0);
  EXPECT_NEAR(solver.violations()[2], -2, 1e-12);
  EXPECT_EQ(solver.violations()[3], 0);
}

TEST(SoftRows, WithCrossedBoundsEndBetweenThem) {
  QuadraticProgram program = nearest(Eigen::Vector2d(0, 7));
  program.add_bound(0, 4, 2, {2, 1.0});
  program.add_bound(1, 4, 2, {2, 1.0});
  Solver solver;
  ASSERT_EQ(solver.solve(program), Status::kOptimal);
  EXPECT_LT((solver.u() - Eigen::Vector2d(2, 4)).norm(), 1e-12);
  EXPECT_NEAR(std::abs(solver.violations()[0]) + std::abs(solver.violations()[1]), 4, 1e-12);
}

class RandomPrograms : public ::testing::TestWithParam<int> {
 protected:
  Family family() const { return static_cast<Family>(GetParam()); }
  bool is_feasible() const { return family() != Family::kInfeasible; }
};
INSTANTIATE_TEST_SUITE_P(Families, RandomPrograms, ::testing::Range(0, support::kFamilies),
                         [](const auto& instance) {
                           return support::name(static_cast<Family>(instance.param));
                         });

// A thousand of each of the ten families: for a strictly convex program these conditions, checked
// in long double from its numbers alone, hold at the optimum and nowhere else.
TEST_P(RandomPrograms, AnswersProveThemselves) {
  Random random(1, support::name(family()));
  Solver solver;
  for (int i = 0; i < 1000; ++i) {
    const QuadraticProgram program = support::random_program(family(), 14, 64, random);
    const Status status = solver.solve(program, Start::kCold);
    ASSERT_EQ(status, is_feasible() ? Status::kOptimal : Status::kInfeasible) << "program " << i;
    if (status == Status::kInfeasible) {
      EXPECT_TRUE(support::proves_infeasibility(program, solver)) << "program " << i;
      continue;
    }
    const support::OptimalityError error = support::optimality_error(program, solver);
    EXPECT_LT(error.stationarity, 1e-11) << "program " << i;
    EXPECT_LT(error.feasibility, 1e-10) << "program " << i;
    EXPECT_LT(error.complementarity, 1e-10) << "program " << i;
  }
}

#ifdef PALPATE_EXACT_SOLVER
TEST_P(RandomPrograms, AnswersAreThoseOfAnExactSolver) {
  Random random(2, support::name(family()));
  Solver solver;
  for (int i = 0; i < 1000; ++i) {
    const QuadraticProgram program = support::random_program(family(), 6, 16, random);
    const Status status = solver.solve(program, Start::kCold);
    const std::optional<VectorXd> exact = support::exact_answer(program);
    ASSERT_EQ(status == Status::kOptimal, exact.has_value()) << "program " << i;
    if (!exact) continue;
    const MatrixXd H = MatrixXd(program.H).selfadjointView<Eigen::Lower>();
    const VectorXd off = solver.u() - *exact;
    const double scale = support::Scales(program).program + std::sqrt(exact->dot(H * *exact));
    EXPECT_LE(std::sqrt(off.dot(H * off)), 1e-9 * scale) << "program " << i;
  }
}
#endif

// The next program of a servo loop is similar to its previous one.
TEST_P(RandomPrograms, WarmStartsChangeTheWorkAndNotTheAnswer) {
  if (!is_feasible()) GTEST_SKIP() << "there is no last optimum to start from";
  Random random(3, support::name(family()));
  Solver warm, cold;
  int warm_iterations = 0;
  int cold_iterations = 0;
  for (int i = 0; i < 50; ++i) {
    QuadraticProgram program = support::random_program(family(), 14, 64, random);
    ASSERT_EQ(warm.solve(program, Start::kCold), Status::kOptimal);
    for (int cycle = 0; cycle < 10; ++cycle) {
      support::drift(program, 1e-3, random);
      ASSERT_EQ(warm.solve(program, Start::kWarm), Status::kOptimal);
      ASSERT_EQ(cold.solve(program, Start::kCold), Status::kOptimal);
      warm_iterations += warm.iterations();
      cold_iterations += cold.iterations();
      EXPECT_LT(support::optimality_error(program, warm).largest(), 1e-10);
      const double size = std::max(warm.u().norm(), cold.u().norm());
      EXPECT_LE((warm.u() - cold.u()).norm(), 1e-7 * size);
    }
  }
  EXPECT_LT(warm_iterations, 0.5 * cold_iterations);
}

TEST(QuadraticProgram, WarmStartsFromAnythingReachTheSameAnswer) {
  Random random(4);
  Solver solver, cold;
  int solved = 0;
  for (int i = 0; i < 3000; ++i) {
    // Same size, different programs: the last active rows give no information about this one.
    const auto family = static_cast<Family>(random.below(support::kFamilies));
    const QuadraticProgram program = support::random_program(family, 3, 9, random);
    const Status status = solver.solve(program, Start::kWarm);
    ASSERT_EQ(status, cold.solve(program, Start::kCold)) << "program " << i;
    if (status != Status::kOptimal) continue;
    ++solved;
    EXPECT_LT(support::optimality_error(program, solver).largest(), 1e-10) << "program " << i;
  }
  EXPECT_GT(solved, 2000);
}

TEST(QuadraticProgram, SolvesWithoutAllocating) {
  if (loop::allocations_of_this_thread() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
  Random random(5);
  Solver solver;
  std::int64_t allocations = 0;
  for (int i = 0; i < 200; ++i) {
    const auto family = static_cast<Family>(i % support::kFamilies);
    const QuadraticProgram made = support::random_program(family, 14, 64, random);
    QuadraticProgram program(made.variables());
    const MatrixXd rows = MatrixXd(made.A.leftCols(made.rows())).transpose();
    const loop::NoAllocationScope scope;
    program.H = made.H;
    program.g = made.g;
    program.clear_rows();
    for (int row = 0; row < made.rows(); ++row) {
      const QuadraticProgram::Bounds& bounds = made.bounds[row];
      program.add_row(rows.row(row), bounds.lower, bounds.upper, bounds.priority);
    }
    program.bounds[0].lower -= 1e-3;
    solver.solve(program, Start::kCold);
    solver.solve(program, Start::kWarm);
    allocations += scope.count();
  }
  EXPECT_EQ(allocations, 0);
}

}  // namespace
}  // namespace palpate::math
