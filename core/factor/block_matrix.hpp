#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace palpate::factor {

/// Undirected graph: the neighbours of node i are neighbours[start[i]] to neighbours[start[i + 1] -
/// 1], without i itself; each edge is stored at both ends.
struct Graph {
  std::vector<int> start{0};  // length size() + 1
  std::vector<int> neighbours;

  int size() const { return static_cast<int>(start.size()) - 1; }
};

/// Elimination orders of a graph that another library proposes, each as below.
using Orders = std::vector<std::vector<int>> (*)(const Graph& graph);

/// Fill-reducing elimination order of the nodes of a graph: entry k is the node eliminated k-th.
/// The best of several nested dissections (METIS), of approximate minimum degree and of `more`,
/// unless null, by the size of the factor, in postorder of its elimination tree. The final `last`
/// nodes of the graph keep their positions at the end. Deterministic.
std::vector<int> elimination_order(const Graph& graph, int last = 0, Orders more = nullptr);

/// Grasp patches whose nodes are held at zero in a solution.
using Held = std::array<bool, 2>;

/// Several nodal vectors, 3 n x k: the three axes of a node in consecutive rows.
using NodalColumns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Sparsity pattern: which nodes of a mesh are unknowns, in an elimination order that keeps factors
/// sparse, and which 3 x 3 blocks of a stiffness matrix over them are non-zero. Only blocks (i, k)
/// with i >= k are stored, column by column, the diagonal block first. Grasp patches ("border"
/// groups) are ordered after all other unknowns, group after group, so that the factor of the
/// interior is the same whether they are held or not.
class BlockPattern {
 public:
  /// elements: nodes x count. Nodes in `fixed` are removed permanently. `more`: of
  /// elimination_order(). Throws std::invalid_argument for more than two border groups, a border
  /// node that is fixed or in both groups, or a node out of range.
  BlockPattern(const Eigen::MatrixXi& elements, int node_count, const std::vector<int>& fixed,
               const std::vector<std::vector<int>>& border = {}, Orders more = nullptr);

  int size() const { return static_cast<int>(node_.size()); }
  int interior_size() const { return border_begin_[0]; }  // number of unknowns in no border group
  /// Unknowns of group 0 or 1, in the order of its node list; empty if the group does not exist.
  int border_begin(int group) const { return border_begin_[group]; }
  int border_end(int group) const { return border_begin_[group + 1]; }
  bool is_free(int unknown, Held held) const {
    return unknown < border_begin_[0] || !held[unknown >= border_begin_[1]];
  }
  /// Index, 0 to 3, of a set of held groups; a non-existent group counts as held.
  int held_set(Held held) const {
    const bool first = held[0] || border_begin_[0] == border_begin_[1];
    const bool second = held[1] || border_begin_[1] == border_begin_[2];
    return first + 2 * second;
  }
  int node(int unknown) const { return node_[unknown]; }
  int unknown(int node) const { return unknown_[node]; }  // unknown of a node; -1 if fixed
  int node_count() const { return static_cast<int>(unknown_.size()); }

  const std::vector<int>& column_start() const { return column_start_; }  // length size() + 1
  const std::vector<int>& row() const { return row_; }  // ascending in each column

  /// Index of block (a, b) of an element's matrix among the stored blocks; -1 if its transpose is
  /// stored instead or a node is fixed.
  int slot(int element, int a, int b) const {
    return slots_[(element * nodes_per_element_ + a) * nodes_per_element_ + b];
  }

 private:
  int nodes_per_element_;
  std::array<int, 3> border_begin_{};
  std::vector<int> node_, unknown_, column_start_, row_, slots_;
};

/// Symmetric matrix of 3 x 3 blocks over the unknown nodes of a pattern.
class BlockMatrix {
 public:
  explicit BlockMatrix(const BlockPattern& pattern);

  const BlockPattern& pattern() const { return *pattern_; }
  const Eigen::Matrix3d& block(int k) const { return blocks_[k]; }
  Eigen::Matrix3d& block(int k) { return blocks_[k]; }

  void set_zero();
  /// Adds `factor` times another matrix of the same pattern.
  void add(double factor, const BlockMatrix& other) noexcept;
  /// Adds `factor` times a matrix of multiples of the identity, one number per block.
  void add_scalar(double factor, const Eigen::VectorXd& blocks) noexcept;
  /// Adds an element's symmetric matrix, 3 N x 3 N.
  void add(int element, const Eigen::MatrixXd& K);
  /// Adds `factor` times an element's N x N matrix, identical for each axis.
  void add_scalar(int element, double factor, const Eigen::MatrixXd& M);

  /// y = A u over all nodes, 3 x n; rows of fixed nodes are zero, columns of fixed nodes ignored.
  void multiply(const Eigen::Matrix3Xd& u, Eigen::Matrix3Xd& y) const;
  /// The same for several vectors at once; their number is a multiple of four.
  void multiply(const NodalColumns& u, NodalColumns& y) const noexcept;

 private:
  const BlockPattern* pattern_;
  std::vector<Eigen::Matrix3d> blocks_;
};

}  // namespace palpate::factor
