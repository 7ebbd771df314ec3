#ifdef PALPATE_SUITESPARSE

#include "core/factor/cholmod/cholmod_factor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <thread>
#include <vector>

#include "core/factor/solve_panels.hpp"
#include "core/math/blas.hpp"
#include "tests/unit/core/factor/block_systems.hpp"

namespace palpate::factor {
namespace {

using mesh::ElementOrder;

/// Largest entry of A - B relative to the largest of B.
double difference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return (A - B).cwiseAbs().maxCoeff() / B.cwiseAbs().maxCoeff();
}

/// CHOLMOD's factor compared with the own one and with dense factors, for every set of held groups.
void expect_same(const BlockSystem& system, double tolerance, double shift = 0) {
  const Supernodes nodes(system.pattern);
  SupernodalFactor own(nodes);
  CholmodFactor factor(nodes);
  ASSERT_TRUE(own.factorise(system.matrix, shift));
  ASSERT_TRUE(factor.factorise(system.matrix, shift));
  EXPECT_TRUE(factor.is_cholmod());
  EXPECT_EQ(factor.is_interior_positive(), own.is_interior_positive());
  EXPECT_EQ(factor.diagonal(), own.diagonal());
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(3 * system.pattern.size(), 11);
  for (Held held : kHeldSets) {
    ASSERT_EQ(factor.is_regular(held), own.is_regular(held));
    EXPECT_EQ(factor.is_positive(held), own.is_positive(held));
    EXPECT_EQ(factor.pivots(held).negative, own.pivots(held).negative);
    const std::vector<int> rows = system.free_rows(held);
    if (!factor.is_regular(held) || rows.empty()) continue;
    EXPECT_NEAR(factor.pivots(held).smallest, own.pivots(held).smallest, 1e-8);
    Eigen::MatrixXd X = B, of_own = B, again = B;
    factor.solve(X, held);
    own.solve(of_own, held);
    EXPECT_LT(difference(X, of_own), tolerance);
    Eigen::MatrixXd A = system.free_part(held);
    A.diagonal().array() += shift;
    const Eigen::MatrixXd expected = A.partialPivLu().solve(Eigen::MatrixXd(B(rows, Eigen::all)));
    EXPECT_LT(difference(X(rows, Eigen::all), expected), tolerance);
    EXPECT_TRUE(factor.factorise(system.matrix, shift));
    factor.solve(again, held);
    EXPECT_EQ(X, again) << "repeats to the bit";
  }
}

TEST(CholmodFactor, SolvesAsTheOwnAndADenseFactorDo) {
  std::srand(1);
  for (ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    const TwoHandedBar bar(order, {4, 2, 1});
    for (int groups = 0; groups <= 2; ++groups) {
      const std::vector<std::vector<int>> border(bar.ends.begin(), bar.ends.begin() + groups);
      BlockSystem system(bar.body.mesh, bar.middle, border);
      system.add_stiffness(bar.set, bar.body.mesh.nodes);
      expect_same(system, 1e-10);
      BlockSystem random(bar.body.mesh, {}, border);
      random.add_random();
      random.add_stiffness(bar.set, bar.body.mesh.nodes);
      expect_same(random, 1e-7);
    }
  }
}

TEST(CholmodFactor, SolvesABodyThatOnlyHandsSupport) {
  const TwoHandedBar bar(ElementOrder::kQuadratic);
  BlockSystem floating(bar.body.mesh, {}, bar.ends);
  floating.add_stiffness(bar.set, bar.body.mesh.nodes);
  expect_same(floating, 1e-9);
  expect_same(floating, 1e-9, 1e-4 * floating.dense.diagonal().maxCoeff());
}

TEST(CholmodFactor, TakesAnEmptyInterior) {
  const mesh::ElementMesh mesh =
      mesh::make_element_mesh(mesh::make_box({1, 1, 1}, {1, 1, 1}), ElementOrder::kLinear);
  BlockSystem system(mesh, {}, {{0, 1, 2, 3}, {7, 6, 5, 4}});
  std::srand(4);
  system.add_random();
  expect_same(system, 1e-7);
}

// Compressed by 40 % the bar buckles: the own factor takes over, with its inertia.
TEST(CholmodFactor, LeavesIndefiniteMatricesToTheOwnFactor) {
  const TwoHandedBar bar(ElementOrder::kQuadratic);
  BlockSystem system(bar.body.mesh, bar.middle, bar.ends);
  Eigen::Matrix3Xd x = bar.body.mesh.nodes;
  x.row(0) = 0.6 * x.row(0);
  std::srand(2);
  x += 2e-3 * Eigen::Matrix3Xd::Random(3, x.cols());
  system.add_stiffness(bar.set, x);
  const Supernodes nodes(system.pattern);
  SupernodalFactor own(nodes);
  CholmodFactor factor(nodes);
  ASSERT_TRUE(own.factorise(system.matrix));
  ASSERT_TRUE(factor.factorise(system.matrix));
  EXPECT_FALSE(factor.is_cholmod());
  for (Held held : kHeldSets) {
    EXPECT_GT(factor.pivots(held).negative, 0);
    EXPECT_EQ(factor.pivots(held).negative, own.pivots(held).negative);
    EXPECT_EQ(factor.pivots(held).smallest, own.pivots(held).smallest);
  }
  // and CHOLMOD resumes with the next matrix that is positive definite
  ASSERT_TRUE(factor.factorise(system.matrix, 4 * system.dense.diagonal().maxCoeff()));
  EXPECT_TRUE(factor.is_cholmod());
}

TEST(CholmodFactor, RefusesSingularMatrices) {
  const TwoHandedBar bar(ElementOrder::kQuadratic);
  BlockSystem free(bar.body.mesh, {}, {});
  free.add_stiffness(bar.set, bar.body.mesh.nodes);
  const Supernodes nodes(free.pattern);
  CholmodFactor factor(nodes);
  EXPECT_FALSE(factor.factorise(free.matrix));
  EXPECT_FALSE(factor.is_regular({false, false}));
}

TEST(CholmodFactor, FillsThePanelsOfTheLoopAsTheOwnFactorDoes) {
  const TwoHandedBar bar(ElementOrder::kQuadratic);
  BlockSystem system(bar.body.mesh, bar.middle, bar.ends);
  system.add_stiffness(bar.set, bar.body.mesh.nodes);
  const Supernodes nodes(system.pattern);
  CholmodFactor factor(nodes);
  ASSERT_TRUE(factor.factorise(system.matrix));
  SolvePanels panels(nodes, PanelPrecision::kSingle);
  ASSERT_TRUE(panels.assign(factor));
  for (Held held : kHeldSets) {
    const Eigen::VectorXf b = Eigen::VectorXf::Random(3 * system.pattern.size());
    Eigen::VectorXf x = b;
    panels.solve(x.data(), held);
    EXPECT_LT(difference(x.cast<double>(), system.solve(b.cast<double>(), held)), 5e-6);
  }
}

int threads_of_this_process() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<int>(std::distance(begin(tasks), end(tasks)));
}

// Large enough for CHOLMOD's parallel regions and for the threads of a parallel BLAS.
TEST(CholmodFactor, OpensNoThread) {
  const TwoHandedBar bar(ElementOrder::kLinear, {24, 6, 6});
  BlockSystem system(bar.body.mesh, bar.middle, bar.ends);
  system.add_stiffness(bar.set, bar.body.mesh.nodes);
  const Supernodes nodes(system.pattern);
  CholmodFactor factor(nodes);
  ASSERT_TRUE(factor.factorise(system.matrix));
  EXPECT_TRUE(factor.is_cholmod());
  const math::Blas blas = math::hold_blas_to_one_thread();
  EXPECT_EQ(threads_of_this_process(), 1) << "OpenMP, or the BLAS " << blas.file;
  EXPECT_EQ(blas.threads, 1) << blas.file;
}

// With a BLAS without locks one factor in 30 to 90 is wrong here.
TEST(CholmodFactor, SeveralThreadsFactorAtTheSameTime) {
  constexpr int kThreads = 3, kFactors = 1'000;
  const TwoHandedBar bar(ElementOrder::kLinear, {6, 3, 3});
  BlockSystem system(bar.body.mesh, bar.middle, bar.ends);
  system.add_stiffness(bar.set, bar.body.mesh.nodes);
  const Supernodes nodes(system.pattern);
  CholmodFactor reference(nodes);
  ASSERT_TRUE(reference.factorise(system.matrix));
  const auto solved_by = [&](const CholmodFactor& factor) {
    Eigen::MatrixXd x = Eigen::VectorXd::LinSpaced(3 * system.pattern.size(), -1, 1);
    factor.solve(x, kHeldSets.back());
    return x;
  };
  const Eigen::MatrixXd expected = solved_by(reference);
  std::array<int, kThreads> wrong{};
  std::vector<std::thread> threads;
  for (int& count : wrong) {
    threads.emplace_back([&] {
      CholmodFactor factor(nodes);
      for (int k = 0; k < kFactors; ++k)
        if (!factor.factorise(system.matrix) || !factor.is_cholmod() ||
            solved_by(factor) != expected)
          ++count;
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : wrong) EXPECT_EQ(count, 0) << "of " << kFactors;
}

}  // namespace
}  // namespace palpate::factor

#endif
