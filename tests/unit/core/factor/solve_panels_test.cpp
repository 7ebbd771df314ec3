#include "core/factor/solve_panels.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/factor/block_systems.hpp"

namespace palpate::factor {
namespace {

using mesh::ElementOrder;

/// Largest relative error over the sets of held groups.
double error(const BlockSystem& system, PanelPrecision precision) {
  const Supernodes nodes(system.pattern);
  SupernodalFactor factor(nodes);
  SolvePanels panels(nodes, precision);
  EXPECT_TRUE(factor.factorise(system.matrix));
  EXPECT_TRUE(panels.assign(factor));
  double largest = 0;
  for (Held held : kHeldSets) {
    EXPECT_TRUE(panels.usable(held));
    const Eigen::VectorXf b = Eigen::VectorXf::Random(3 * system.pattern.size());
    Eigen::VectorXf x = b, again = b;
    panels.solve(x.data(), held);
    const Eigen::VectorXd expected = system.solve(b.cast<double>(), held);
    largest = std::max(largest, (x.cast<double>() - expected).norm() / expected.norm());
    for (int k = 0; k < system.pattern.size(); ++k) {
      EXPECT_TRUE(system.pattern.is_free(k, held) || x.segment<3>(3 * k).isZero(0));
    }
    panels.solve(again.data(), held);
    EXPECT_EQ(x, again) << "repeats to the bit";
  }
  return largest;
}

TEST(SolvePanels, SolveAsADenseFactorDoesWithinThePrecision) {
  std::srand(1);
  for (ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    for (const std::array<int, 3>& cells : {std::array<int, 3>{2, 1, 1}, {6, 3, 2}}) {
      const TwoHandedBar bar(order, cells);
      for (int groups = 0; groups <= 2; ++groups) {
        const std::vector<std::vector<int>> border(bar.ends.begin(), bar.ends.begin() + groups);
        BlockSystem system(bar.body.mesh, bar.middle, border);
        system.add_stiffness(bar.set, bar.body.mesh.nodes);
        EXPECT_LT(error(system, PanelPrecision::kSingle), 5e-6);
        const double half = error(system, PanelPrecision::kHalf);
        EXPECT_LT(half, 2e-3);
      }
    }
  }
}

TEST(SolvePanels, SolveRandomMatricesAndEmptyInteriors) {
  std::srand(2);
  const TwoHandedBar bar(ElementOrder::kLinear);
  BlockSystem system(bar.body.mesh, {}, {bar.ends[1], bar.middle});
  system.add_random();
  system.add_stiffness(bar.set, bar.body.mesh.nodes);
  EXPECT_LT(error(system, PanelPrecision::kSingle), 1e-5);

  const mesh::ElementMesh cube =
      mesh::make_element_mesh(mesh::make_box({1, 1, 1}, {1, 1, 1}), ElementOrder::kLinear);
  BlockSystem all_border(cube, {}, {{0, 1, 2, 3}, {4, 5, 6, 7}});
  all_border.add_random();
  EXPECT_LT(error(all_border, PanelPrecision::kSingle), 1e-3) << "ill-conditioned";
}

TEST(SolvePanels, KnowWhatTheyCannotBeUsedFor) {
  const TwoHandedBar bar(ElementOrder::kQuadratic);
  BlockSystem floating(bar.body.mesh, {}, bar.ends);
  floating.add_stiffness(bar.set, bar.body.mesh.nodes);
  const Supernodes nodes(floating.pattern);
  SupernodalFactor factor(nodes);
  SolvePanels panels(nodes, PanelPrecision::kHalf);
  for (Held held : kHeldSets) EXPECT_FALSE(panels.usable(held));
  ASSERT_TRUE(factor.factorise(floating.matrix));
  EXPECT_TRUE(panels.assign(factor));
  for (Held held : kHeldSets) EXPECT_EQ(panels.usable(held), held[0] || held[1]);

  ASSERT_TRUE(factor.factorise(floating.matrix, -floating.dense.diagonal().maxCoeff()));
  EXPECT_FALSE(panels.assign(factor)) << "the interior is indefinite";
  for (Held held : kHeldSets) EXPECT_FALSE(panels.usable(held));
}

}  // namespace
}  // namespace palpate::factor
