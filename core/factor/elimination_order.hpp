#pragma once

#include <vector>

namespace palpate::factor {

/// Undirected graph: the neighbours of node i are neighbours[start[i]] to neighbours[start[i + 1] -
/// 1], without i itself; each edge is stored at both ends.
struct Graph {
  std::vector<int> start{0};  // length size() + 1
  std::vector<int> neighbours;

  int size() const { return static_cast<int>(start.size()) - 1; }
};

/// Fill-reducing elimination order of the nodes of a graph: entry k is the node eliminated k-th.
/// The best of several nested dissections (METIS) and of approximate minimum degree, by the size of
/// the factor, in postorder of its elimination tree. The final `last` nodes of the graph keep their
/// positions at the end. Deterministic.
std::vector<int> elimination_order(const Graph& graph, int last = 0);

}  // namespace palpate::factor
