#pragma once

#include <Eigen/Geometry>
#include <Eigen/StdVector>
#include <vector>

#include "core/elasticity/body.hpp"
#include "tests/bench/core/elasticity/baseline_lanes.hpp"

namespace palpate::bench {

/// Symmetric matrix of 3 x 3 blocks over n nodes, both triangles stored, block row by block row
/// with ascending columns. Blocks are column-major with a row of padding, for full-width vectors.
struct BlockRows {
  using Block = Eigen::Matrix<double, 4, 3>;
  std::vector<int> row_start;  // n + 1
  std::vector<int> column;
  std::vector<Block> blocks;

  int size() const { return static_cast<int>(row_start.size()) - 1; }
  /// y = A x; 4 x n, row 3 zero.
  void multiply(const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& y) const;
};

/// Co-rotated elasticity, implemented plainly and independently of the model under test: residual
/// forces and exact tangent of
///   E(x) - f.x + |x - x*|^2_M inertia / 2
/// over the nodes that are not prescribed. Double precision, four elements at a time; pattern and
/// masses are computed once.
class BaselineSystem {
 public:
  /// Prescribed: fixed nodes and those of grasp 0. Stiffness damping is not supported; throws
  /// std::invalid_argument if the body has some.
  explicit BaselineSystem(const elasticity::Body& body);

  int size() const { return static_cast<int>(node_.size()); }
  int node(int unknown) const { return node_[unknown]; }

  /// Fills matrix() and residual() at positions x. inertia: 1/s^2, 0 for statics.
  void assemble(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& x_inertial,
                const Eigen::Matrix3Xd& loads, double inertia);

  const BlockRows& matrix() const { return matrix_; }
  const Eigen::Matrix4Xd& residual() const { return residual_; }  // N, 4 x unknowns

  /// Quadrature points with det F <= 0.
  int inverted(const Eigen::Matrix3Xd& x) const;

 private:
  template <int kNodes>
  using Points = std::vector<LanePoint<kNodes>>;
  template <int kNodes>
  void add_rest_points(const elasticity::Body& body, Points<kNodes>& points);
  template <int kNodes>
  void add_elements(const Eigen::Matrix3Xd& x, Points<kNodes>& points);
  template <int kNodes>
  int count_inverted(const Eigen::Matrix3Xd& x, const Points<kNodes>& points) const;
  void find_pattern();
  void add_mass(const elasticity::Body& body);

  Eigen::MatrixXi elements_;
  Points<4> linear_;  // points of elements 0 to 3, then of 4 to 7, ...
  Points<10> quadratic_;
  std::vector<int> node_, unknown_;
  std::vector<int> slots_;      // of each element's N x N blocks, -1 where prescribed
  std::vector<double> masses_;  // kg, by block of the matrix
  std::vector<int> mass_start_, mass_column_;  // rows of all unknowns over all nodes
  std::vector<double> mass_;
  BlockRows matrix_;
  Eigen::Matrix4Xd residual_;
};

}  // namespace palpate::bench
