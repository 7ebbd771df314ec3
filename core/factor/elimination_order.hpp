#pragma once

#include <vector>

namespace palpate::factor {

/// Undirected graph: the neighbours of node i are neighbours[start[i]] to neighbours[start[i + 1]],
/// without i itself; each edge stands at both of its ends.
struct Graph {
  std::vector<int> start{0};  // size() + 1
  std::vector<int> neighbours;

  int size() const { return static_cast<int>(start.size()) - 1; }
};

/// Order in which the nodes of a graph are eliminated so that the factor stays sparse: entry k is
/// the node eliminated k-th. The best of several nested dissections (METIS) and of approximate
/// minimum degree, by the size of the factor, in postorder of its elimination tree. The `last`
/// last nodes of the graph keep their places at the end. The same for the same graph.
std::vector<int> elimination_order(const Graph& graph, int last = 0);

}  // namespace palpate::factor
