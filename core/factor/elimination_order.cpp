#include "core/factor/block_matrix.hpp"

#include <metis.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace palpate::factor {
namespace {

/// Number of dissections with different seeds, whose factors differ in size by about 10 %.
constexpr int kDissections = 12;

struct EliminationTree {
  std::vector<int> parent;  // -1 at a root
  std::vector<int> count;   // entries of each column of the factor below its diagonal
  long entries = 0;
};

EliminationTree elimination_tree(const Graph& graph, const std::vector<int>& order) {
  const int n = graph.size();
  std::vector<int> place(n), flag(n, -1);
  for (int k = 0; k < n; ++k) place[order[k]] = k;
  EliminationTree tree{std::vector<int>(n, -1), std::vector<int>(n, 0), 0};
  for (int k = 0; k < n; ++k) {
    flag[k] = k;
    for (int s = graph.start[order[k]]; s < graph.start[order[k] + 1]; ++s) {
      int i = place[graph.neighbours[s]];
      if (i > k) continue;
      for (; flag[i] != k; i = tree.parent[i]) {
        if (tree.parent[i] < 0) tree.parent[i] = k;
        ++tree.count[i];
        ++tree.entries;
        flag[i] = k;
      }
    }
  }
  return tree;
}

/// Equivalent elimination order in which the columns of each subtree are contiguous. The child with
/// the longest column comes last, next to its parent, with which it is most likely to form a
/// supernode.
std::vector<int> postorder(const std::vector<int>& order, const EliminationTree& tree, int last) {
  const int n = static_cast<int>(order.size()), interior = n - last;
  std::vector<std::vector<int>> children(interior + 1);  // index `interior`: the roots
  for (int k = 0; k < interior; ++k) {
    const int parent = tree.parent[k];
    children[parent < 0 ? interior : std::min(parent, interior)].push_back(k);
  }
  for (std::vector<int>& c : children) {
    // entries are taken from the end while the order is built backwards
    std::stable_sort(c.begin(), c.end(),
                     [&](int a, int b) { return tree.count[a] < tree.count[b]; });
  }
  std::vector<int> result(order), stack = children[interior];
  for (int k = interior - 1; k >= 0; --k) {
    const int column = stack.back();
    stack.pop_back();
    result[k] = order[column];
    stack.insert(stack.end(), children[column].begin(), children[column].end());
  }
  return result;
}

Graph without_last(const Graph& graph, int last) {
  const int n = graph.size() - last;
  Graph inner;
  for (int i = 0; i < n; ++i) {
    for (int s = graph.start[i]; s < graph.start[i + 1]; ++s) {
      if (graph.neighbours[s] < n) inner.neighbours.push_back(graph.neighbours[s]);
    }
    inner.start.push_back(static_cast<int>(inner.neighbours.size()));
  }
  return inner;
}

std::vector<int> minimum_degree(const Graph& graph) {
  const int n = graph.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1);
    for (int s = graph.start[i]; s < graph.start[i + 1]; ++s) {
      entries.emplace_back(i, graph.neighbours[s], 1);
    }
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(n);
  Eigen::AMDOrdering<int>()(matrix, permutation);
  return {permutation.indices().data(), permutation.indices().data() + n};
}

/// METIS seeds and uses rand(): during the lifetime of this object rand() has a private state.
class OwnRandomState {
 public:
  OwnRandomState() : previous_(initstate(1, state_, sizeof state_)) {}
  ~OwnRandomState() { setstate(previous_); }
  OwnRandomState(const OwnRandomState&) = delete;

 private:
  char state_[128];
  char* previous_;
};

/// Empty if METIS reports an error.
std::vector<int> nested_dissection(const Graph& graph, int seed) {
  std::vector<idx_t> start(graph.start.begin(), graph.start.end());
  std::vector<idx_t> neighbours(graph.neighbours.begin(), graph.neighbours.end());
  idx_t n = graph.size(), options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = seed;
  std::vector<idx_t> order(n), place(n);
  const OwnRandomState own_random_state;
  if (METIS_NodeND(&n, start.data(), neighbours.data(), nullptr, options, order.data(),
                   place.data()) != METIS_OK) {
    return {};
  }
  return {order.begin(), order.end()};
}

}  // namespace

std::vector<int> elimination_order(const Graph& graph, int last, Orders more) {
  const int n = graph.size(), interior = n - last;
  const Graph inner = without_last(graph, last);
  std::vector<int> best(n);
  std::iota(best.begin(), best.end(), 0);
  EliminationTree tree = elimination_tree(graph, best);
  const auto consider = [&](std::vector<int> order) {
    if (static_cast<int>(order.size()) != interior) return;
    for (int i = interior; i < n; ++i) order.push_back(i);
    EliminationTree candidate = elimination_tree(graph, order);
    if (candidate.entries >= tree.entries) return;
    best = std::move(order);
    tree = std::move(candidate);
  };
  if (!inner.neighbours.empty()) {
    consider(minimum_degree(inner));
    for (int seed = 0; seed < kDissections; ++seed) consider(nested_dissection(inner, seed));
    if (more != nullptr) {
      const OwnRandomState own_random_state;
      for (std::vector<int>& order : more(inner)) consider(std::move(order));
    }
  }
  return postorder(best, tree, last);
}

}  // namespace palpate::factor
