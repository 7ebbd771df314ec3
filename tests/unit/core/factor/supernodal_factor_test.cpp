#include "core/factor/supernodal_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/unit/core/factor/block_systems.hpp"

namespace palpate::factor {
namespace {

using mesh::ElementOrder;

int negative_eigenvalues(const Eigen::MatrixXd& A) {
  return static_cast<int>((Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly)
                               .eigenvalues()
                               .array() < 0)
                              .count());
}

/// For every set of held groups, compared with dense factors.
void expect_solves(const BlockSystem& system, double tolerance, double shift = 0) {
  const Supernodes nodes(system.pattern);
  SupernodalFactor factor(nodes);
  ASSERT_TRUE(factor.factorise(system.matrix, shift));
  const int n = 3 * system.pattern.size();
  for (Held held : kHeldSets) {
    ASSERT_TRUE(factor.is_regular(held));
    const std::vector<int> rows = system.free_rows(held);
    if (rows.empty()) continue;
    Eigen::MatrixXd A = system.free_part(held);
    A.diagonal().array() += shift;
    EXPECT_EQ(factor.pivots(held).negative, negative_eigenvalues(A));
    EXPECT_EQ(factor.is_positive(held), factor.pivots(held).negative == 0);
    const Eigen::MatrixXd B = Eigen::MatrixXd::Random(n, 11);
    Eigen::MatrixXd X = B, again = B;
    factor.solve(X, held);
    const Eigen::MatrixXd expected = A.partialPivLu().solve(Eigen::MatrixXd(B(rows, Eigen::all)));
    EXPECT_LT((X(rows, Eigen::all) - expected).norm(), tolerance * expected.norm());
    EXPECT_NEAR(X.squaredNorm(), X(rows, Eigen::all).squaredNorm(), 1e-12 * X.squaredNorm());
    factor.solve(again, held);
    EXPECT_EQ(X, again) << "repeats to the bit";
  }
}

TEST(SupernodalFactor, SolvesRandomMatricesAsADenseFactorDoes) {
  std::srand(1);
  for (ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    const TwoHandedBar bar(order, {4, 2, 1});
    for (int groups = 0; groups <= 2; ++groups) {
      const std::vector<std::vector<int>> border(bar.ends.begin(), bar.ends.begin() + groups);
      for (const std::vector<int>& fixed : {std::vector<int>(), bar.middle}) {
        BlockSystem system(bar.body.mesh, fixed, border);
        system.add_random();
        expect_solves(system, 1e-8);
      }
    }
  }
}

TEST(SupernodalFactor, SolvesStiffnessMatricesAsADenseFactorDoes) {
  for (ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    const TwoHandedBar bar(order);
    BlockSystem system(bar.body.mesh, bar.middle, bar.ends);
    system.add_stiffness(bar.set, bar.body.mesh.nodes);
    expect_solves(system, 1e-9);
  }
}

// Compressed by 40 % the bar buckles: the tangent is indefinite with and without hands.
TEST(SupernodalFactor, CountsNegativePivots) {
  for (ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    const TwoHandedBar bar(order);
    BlockSystem system(bar.body.mesh, bar.middle, bar.ends);
    Eigen::Matrix3Xd x = bar.body.mesh.nodes;
    x.row(0) = 0.6 * x.row(0);
    std::srand(2);
    x += 2e-3 * Eigen::Matrix3Xd::Random(3, x.cols());
    system.add_stiffness(bar.set, x);
    ASSERT_GT(negative_eigenvalues(system.free_part({true, true})), 0);
    ASSERT_GT(negative_eigenvalues(system.dense),
              negative_eigenvalues(system.free_part({true, true})));
    expect_solves(system, 1e-7);
  }
}

// The smallest pivot warns before the matrix becomes indefinite, and only then.
TEST(SupernodalFactor, SmallestPivotChangesSignWithDefiniteness) {
  const TwoHandedBar bar(ElementOrder::kLinear);
  BlockSystem system(bar.body.mesh, bar.middle, bar.ends);
  system.add_stiffness(bar.set, bar.body.mesh.nodes);
  const Supernodes nodes(system.pattern);
  SupernodalFactor factor(nodes);
  const Held held{false, true};
  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(system.free_part(held)).eigenvalues()(0);
  ASSERT_TRUE(factor.factorise(system.matrix, -0.99 * least));
  const double before = factor.pivots(held).smallest;
  EXPECT_GT(before, 0);
  EXPECT_TRUE(factor.is_positive(held));
  ASSERT_TRUE(factor.factorise(system.matrix, 0));
  EXPECT_GT(factor.pivots(held).smallest, 2 * before);
  ASSERT_TRUE(factor.factorise(system.matrix, -1.01 * least));
  EXPECT_LT(factor.pivots(held).smallest, 0);
  EXPECT_EQ(factor.pivots(held).negative, 1);
}

TEST(SupernodalFactor, RefusesSingularMatrices) {
  const TwoHandedBar bar(ElementOrder::kQuadratic);
  // Free in space unless a hand holds it: the border's part is singular.
  BlockSystem floating(bar.body.mesh, {}, bar.ends);
  floating.add_stiffness(bar.set, bar.body.mesh.nodes);
  const Supernodes nodes(floating.pattern);
  SupernodalFactor factor(nodes);
  ASSERT_TRUE(factor.factorise(floating.matrix));
  EXPECT_FALSE(factor.is_regular({false, false}));
  EXPECT_FALSE(factor.is_positive({false, false}));
  for (Held held : {Held{true, false}, Held{false, true}, Held{true, true}}) {
    EXPECT_TRUE(factor.is_positive(held));
  }
  const double shift = 1e-4 * floating.dense.diagonal().maxCoeff();
  ASSERT_TRUE(factor.factorise(floating.matrix, shift));
  EXPECT_TRUE(factor.is_positive({false, false}));
  expect_solves(floating, 1e-8, shift);

  // Without a border it is the interior that is singular.
  BlockSystem free(bar.body.mesh, {}, {});
  free.add_stiffness(bar.set, bar.body.mesh.nodes);
  const Supernodes of_free(free.pattern);
  SupernodalFactor refusing(of_free);
  EXPECT_FALSE(refusing.factorise(free.matrix));
  EXPECT_FALSE(refusing.is_regular({false, false}));
  EXPECT_TRUE(refusing.factorise(free.matrix, shift));
  EXPECT_TRUE(refusing.is_positive({false, false}));
}

TEST(SupernodalFactor, TakesANodeThatNoElementUses) {
  const TwoHandedBar bar(ElementOrder::kLinear);
  mesh::ElementMesh mesh = bar.body.mesh;
  mesh.nodes.conservativeResize(3, mesh.nodes.cols() + 1);
  mesh.nodes.rightCols(1).setZero();
  BlockSystem system(mesh, bar.middle, bar.ends);
  system.add_stiffness(bar.set, mesh.nodes);
  const Supernodes nodes(system.pattern);
  SupernodalFactor factor(nodes);
  EXPECT_FALSE(factor.factorise(system.matrix));
  expect_solves(system, 1e-8, 1.0);
}

TEST(SupernodalFactor, TakesAnEmptyInterior) {
  const mesh::ElementMesh mesh =
      mesh::make_element_mesh(mesh::make_box({1, 1, 1}, {1, 1, 1}), ElementOrder::kLinear);
  BlockSystem system(mesh, {}, {{0, 1, 2, 3}, {7, 6, 5, 4}});
  ASSERT_EQ(system.pattern.interior_size(), 0);
  std::srand(4);
  system.add_random();
  const Supernodes nodes(system.pattern);
  EXPECT_EQ(nodes.count(), 0);
  expect_solves(system, 1e-8);
}

}  // namespace
}  // namespace palpate::factor
