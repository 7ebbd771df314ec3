#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace palpate::factor {

/// Which grasp patches are kept at zero in a solution.
using Held = std::array<bool, 2>;

/// Nodal vectors side by side, 3 n x k: the axes of a node in consecutive rows.
using NodalColumns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Which nodes of a mesh are unknown, in an order of elimination that keeps factors sparse, and
/// which 3 x 3 blocks of a stiffness matrix over them are not zero. Only blocks (i, k) with i >= k
/// are kept, column by column, the diagonal one first. Grasp patches ("border" groups) are ordered
/// after all other unknowns, group after group, so that the factor of the interior is the same
/// whether they are held or not.
class BlockPattern {
 public:
  /// elements: nodes x count. Nodes in `fixed` are left out for good. Throws std::invalid_argument
  /// for more than two border groups, a border node that is fixed or stands in two groups, or a
  /// node out of range.
  BlockPattern(const Eigen::MatrixXi& elements, int node_count, const std::vector<int>& fixed,
               const std::vector<std::vector<int>>& border = {});

  int size() const { return static_cast<int>(node_.size()); }
  int interior_size() const { return border_begin_[0]; }  // unknowns in no border group
  /// Unknowns of a group, 0 or 1, in the order of its node list; empty where there is no such
  /// group.
  int border_begin(int group) const { return border_begin_[group]; }
  int border_end(int group) const { return border_begin_[group + 1]; }
  bool is_free(int unknown, Held held) const {
    return unknown < border_begin_[0] || !held[unknown >= border_begin_[1]];
  }
  /// Number from 0 to 3 of a set of held groups; one that does not exist counts as held.
  int held_set(Held held) const {
    const bool first = held[0] || border_begin_[0] == border_begin_[1];
    const bool second = held[1] || border_begin_[1] == border_begin_[2];
    return first + 2 * second;
  }
  int node(int unknown) const { return node_[unknown]; }
  int unknown(int node) const { return unknown_[node]; }  // -1 where fixed
  int node_count() const { return static_cast<int>(unknown_.size()); }

  const std::vector<int>& column_start() const { return column_start_; }  // size() + 1
  const std::vector<int>& row() const { return row_; }                    // rising in each column

  /// Index of block (a, b) of an element's matrix among the stored ones, -1 where its mirror image
  /// is the stored one or a node is fixed.
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
  /// Adds `factor` times another of the same pattern.
  void add(double factor, const BlockMatrix& other) noexcept;
  /// Adds `factor` times a matrix of multiples of the unit matrix, one number for each block.
  void add_scalar(double factor, const Eigen::VectorXd& blocks) noexcept;
  /// Adds an element's symmetric matrix, 3 N x 3 N.
  void add(int element, const Eigen::MatrixXd& K);
  /// Adds `factor` times an element's N x N matrix, the same for each axis.
  void add_scalar(int element, double factor, const Eigen::MatrixXd& M);

  /// y = A u over all nodes, 3 x n; rows of fixed nodes are zero, columns of fixed nodes ignored.
  void multiply(const Eigen::Matrix3Xd& u, Eigen::Matrix3Xd& y) const;
  /// The same for many vectors side by side, their number a multiple of four.
  void multiply(const NodalColumns& u, NodalColumns& y) const noexcept;

 private:
  const BlockPattern* pattern_;
  std::vector<Eigen::Matrix3d> blocks_;
};

}  // namespace palpate::factor
