#include "core/factor/solve_panels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::factor {
namespace {

BlockPattern pattern_of(const std::array<int, 3>& cells, mesh::ElementOrder order) {
  const elasticity::Body body = elasticity::make_bar({0.2, 0.05, 0.05}, cells, order);
  return BlockPattern(body.mesh.elements, body.mesh.node_count(), {}, {body.grasps[0].nodes});
}

/// Work of a member at that supernode: its number, or -1 for the top.
std::vector<int> owners(const Supernodes& nodes, const TreeShares& shares) {
  std::vector<int> owner(nodes.count(), -2);
  const auto take = [&owner](int s, int by) {
    EXPECT_EQ(owner[s], -2) << "supernode " << s << " stands in two places";
    owner[s] = by;
  };
  for (std::size_t m = 0; m < shares.members.size(); ++m) {
    for (const auto& range : shares.members[m]) {
      for (int s = range.begin; s < range.end; ++s) take(s, static_cast<int>(m));
    }
  }
  for (const TreeShares::Top& top : shares.top) take(top.node, -1);
  return owner;
}

TEST(TreeShares, SubtreesTouchOnlyThemselvesAndTheTop) {
  for (auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const BlockPattern pattern = pattern_of({12, 3, 3}, order);
    const Supernodes nodes(pattern);
    for (int members = 1; members <= 8; ++members) {
      const TreeShares shares = share_tree(nodes, members);
      ASSERT_EQ(static_cast<int>(shares.members.size()), members);
      const std::vector<int> owner = owners(nodes, shares);
      for (int s = 0; s < nodes.count(); ++s) {
        ASSERT_NE(owner[s], -2) << "supernode " << s << " has no owner";
        for (const int* row = nodes.rows_begin(s); row != nodes.rows_end(s); ++row) {
          if (*row >= pattern.interior_size()) continue;
          int holder = s;
          while (nodes.end(holder) <= *row) ++holder;
          ASSERT_TRUE(owner[holder] == owner[s] || owner[holder] == -1);
        }
      }
      // Subtrees of one member are disjoint as well.
      for (const auto& ranges : shares.members) {
        for (const auto& range : ranges) {
          for (int s = range.begin; s < range.end; ++s) {
            const int parent = nodes.parent(s);
            ASSERT_TRUE(parent < range.end || parent == nodes.count() || owner[parent] == -1);
          }
        }
      }
    }
  }
}

TEST(TreeShares, OneMemberHasAllAndSomeHaveAboutAsMuch) {
  const BlockPattern pattern = pattern_of({24, 5, 5}, mesh::ElementOrder::kLinear);
  const Supernodes nodes(pattern);
  double total = 0;
  for (int s = 0; s < nodes.count(); ++s) total += nodes.cost(s);
  EXPECT_TRUE(share_tree(nodes, 1).top.empty());
  for (int members : {2, 3, 4}) {
    const TreeShares shares = share_tree(nodes, members);
    double busiest = 0, top = 0;
    for (const auto& ranges : shares.members) {
      double load = 0;
      for (const auto& range : ranges) {
        for (int s = range.begin; s < range.end; ++s) load += nodes.cost(s);
      }
      busiest = std::max(busiest, load);
    }
    for (const TreeShares::Top& t : shares.top) top += nodes.cost(t.node);
    EXPECT_LT(busiest + top, 1.8 * total / members) << members;
  }
}

TEST(TreeShares, AnEmptyTreeHasNothingToShare) {
  const elasticity::Body body =
      elasticity::make_bar({1, 1, 1}, {1, 1, 1}, mesh::ElementOrder::kLinear);
  const BlockPattern pattern(body.mesh.elements, body.mesh.node_count(), {},
                             {{0, 1, 2, 3}, {4, 5, 6, 7}});
  const Supernodes nodes(pattern);
  for (int members : {1, 3}) EXPECT_TRUE(share_tree(nodes, members).top.empty());
}

}  // namespace
}  // namespace palpate::factor
