#include "core/factor/block_matrix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "core/factor/supernodes.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

#ifdef PALPATE_SUITESPARSE
#include "core/factor/cholmod/cholmod_orders.hpp"
#endif

namespace palpate::factor {
namespace {

Graph grid(int width, int height) {
  Graph graph;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x > 0) graph.neighbours.push_back(y * width + x - 1);
      if (x + 1 < width) graph.neighbours.push_back(y * width + x + 1);
      if (y > 0) graph.neighbours.push_back((y - 1) * width + x);
      if (y + 1 < height) graph.neighbours.push_back((y + 1) * width + x);
      graph.start.push_back(static_cast<int>(graph.neighbours.size()));
    }
  }
  return graph;
}

/// Entries below the diagonal when nodes are eliminated one after the other.
std::size_t fill(const Graph& graph, const std::vector<int>& order) {
  std::vector<std::set<int>> neighbours(graph.size());
  for (int i = 0; i < graph.size(); ++i) {
    neighbours[i] = {graph.neighbours.begin() + graph.start[i],
                     graph.neighbours.begin() + graph.start[i + 1]};
  }
  std::size_t entries = 0;
  for (int node : order) {
    entries += neighbours[node].size();
    for (int a : neighbours[node]) {
      neighbours[a].erase(node);
      for (int b : neighbours[node]) {
        if (a != b) neighbours[a].insert(b);
      }
    }
  }
  return entries;
}

void expect_permutation(std::vector<int> order, int size) {
  std::sort(order.begin(), order.end());
  ASSERT_EQ(static_cast<int>(order.size()), size);
  for (int i = 0; i < size; ++i) EXPECT_EQ(order[i], i);
}

TEST(EliminationOrder, FillsLessThanTheNaturalOrderAndKeepsTheLastInPlace) {
  const Graph graph = grid(30, 30);
  std::vector<int> natural(graph.size());
  for (int i = 0; i < graph.size(); ++i) natural[i] = i;
  for (int last : {0, 30}) {
    const std::vector<int> order = elimination_order(graph, last);
    expect_permutation(order, graph.size());
    for (int i = graph.size() - last; i < graph.size(); ++i) EXPECT_EQ(order[i], i);
    // The natural order fills a band; nested dissection grows as n log n.
    EXPECT_LT(2 * fill(graph, order), fill(graph, natural));
    EXPECT_EQ(order, elimination_order(graph, last)) << "deterministic";
  }
}

TEST(EliminationOrder, LeavesTheRandomNumbersOfOthersAlone) {
  std::srand(7);
  const int first = std::rand(), second = std::rand();
  std::srand(7);
  EXPECT_EQ(std::rand(), first);
  elimination_order(grid(20, 20));
  EXPECT_EQ(std::rand(), second);
}

TEST(EliminationOrder, TakesEmptyAndDisconnectedGraphs) {
  EXPECT_TRUE(elimination_order(Graph()).empty());
  Graph isolated;
  isolated.start = {0, 0, 0, 0};
  expect_permutation(elimination_order(isolated), 3);
  EXPECT_EQ(elimination_order(isolated, 3), (std::vector<int>{0, 1, 2}));
  Graph apart;  // two edges and an isolated node between them
  apart.start = {0, 1, 2, 2, 3, 4};
  apart.neighbours = {1, 0, 4, 3};
  expect_permutation(elimination_order(apart), 5);
  expect_permutation(elimination_order(apart, 1), 5);
}

TEST(BlockPattern, OrdersGraspPatchesLastAndRefusesWrongOnes) {
  const elasticity::Body body =
      elasticity::make_bar({0.2, 0.05, 0.05}, {4, 2, 2}, mesh::ElementOrder::kLinear);
  const mesh::ElementMesh& mesh = body.mesh;
  const std::vector<int> a = body.grasps[0].nodes, b{elasticity::nodes_at(mesh, 0, 0.1)};
  const auto pattern = [&](const std::vector<std::vector<int>>& border) {
    return BlockPattern(mesh.elements, mesh.node_count(), body.fixed_nodes, border);
  };
  const BlockPattern p = pattern({a, b});
  ASSERT_EQ(p.border_end(1), p.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(p.node(p.border_begin(0) + i), a[i]);
  for (std::size_t i = 0; i < b.size(); ++i) EXPECT_EQ(p.node(p.border_begin(1) + i), b[i]);
  EXPECT_TRUE(p.is_free(p.border_begin(0), {false, true}));
  EXPECT_FALSE(p.is_free(p.border_begin(0), {true, false}));
  EXPECT_FALSE(p.is_free(p.border_begin(1), {false, true}));
  EXPECT_TRUE(p.is_free(0, {true, true}));
  EXPECT_EQ(pattern({a}).border_begin(1), p.size());
  EXPECT_THROW(pattern({a, a}), std::invalid_argument);
  EXPECT_THROW(pattern({{body.fixed_nodes[0]}}), std::invalid_argument);
  EXPECT_THROW(pattern({{mesh.node_count()}}), std::invalid_argument);
  EXPECT_THROW(pattern({{}, {}, {}}), std::invalid_argument);
}

TEST(Supernodes, HoldEveryColumnAndItsRowsOnce) {
  const elasticity::Body body =
      elasticity::make_bar({0.2, 0.05, 0.05}, {6, 3, 3}, mesh::ElementOrder::kQuadratic);
  const BlockPattern pattern(body.mesh.elements, body.mesh.node_count(), body.fixed_nodes,
                             {body.grasps[0].nodes});
  const Supernodes nodes(pattern);
  ASSERT_GT(nodes.count(), 3);
  EXPECT_LT(nodes.count(), pattern.interior_size() / 3) << "columns are merged";
  int column = 0;
  for (int s = 0; s < nodes.count(); ++s) {
    EXPECT_EQ(nodes.begin(s), column);
    column = nodes.end(s);
    const std::set<int> rows(nodes.rows_begin(s), nodes.rows_end(s));
    EXPECT_EQ(static_cast<int>(rows.size()), nodes.rows(s));
    for (int k = nodes.begin(s); k < nodes.end(s); ++k) {
      for (int i = pattern.column_start()[k]; i < pattern.column_start()[k + 1]; ++i) {
        EXPECT_TRUE(pattern.row()[i] < nodes.end(s) || rows.count(pattern.row()[i]));
      }
    }
    const int parent = nodes.parent(s);
    if (parent == nodes.count()) {
      EXPECT_TRUE(rows.empty() || *rows.begin() >= pattern.interior_size());
      continue;
    }
    EXPECT_GT(parent, s);
    const std::set<int> above(nodes.rows_begin(parent), nodes.rows_end(parent));
    for (int row : rows) EXPECT_TRUE(row < nodes.end(parent) || above.count(row));
  }
  EXPECT_EQ(column, pattern.interior_size());
}

#ifdef PALPATE_SUITESPARSE
TEST(EliminationOrder, OrdersOfCholmodAreCandidates) {
  const Graph graph = grid(30, 30);
  const std::vector<std::vector<int>> orders = cholmod_orders(graph);
  ASSERT_EQ(orders.size(), 3U);
  const std::vector<int> own = elimination_order(graph);
  const std::vector<int> best = elimination_order(graph, 0, cholmod_orders);
  expect_permutation(best, graph.size());
  EXPECT_LE(fill(graph, best), fill(graph, own));
  for (const std::vector<int>& order : orders) {
    expect_permutation(order, graph.size());
    EXPECT_LE(fill(graph, best), fill(graph, order));
  }
  EXPECT_EQ(elimination_order(graph, 0, cholmod_orders), best) << "repeats";
}
#endif

}  // namespace
}  // namespace palpate::factor
