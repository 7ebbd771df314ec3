#pragma once

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <vector>

#include "core/elasticity/comparison/comparison_model.hpp"

namespace palpate::baselines {

/// Cholesky factor L D L^T of a graph Laplacian without the rows and columns of prescribed nodes.
/// All axes of a nodal vector are solved together.
class LaplacianFactor {
 public:
  /// `laplacian`: n x n, symmetric, both triangles; `given`: prescribed nodes. Not usable if all
  /// nodes are prescribed, or none of a connected component. Allocates.
  LaplacianFactor(const Eigen::SparseMatrix<double>& laplacian, const std::vector<bool>& given);

  bool is_usable() const noexcept { return usable_; }
  // free nodes, in elimination order
  const std::vector<int>& nodes() const noexcept { return nodes_; }
  /// Overwrites the free nodes' columns of `b`, 3 x n, with the solution; other columns are
  /// unchanged. Requires is_usable().
  void solve(Eigen::Matrix3Xd& b) noexcept;

 private:
  bool usable_ = false;
  std::vector<int> nodes_;
  std::vector<int> start_, row_;
  std::vector<double> lower_, inverse_d_;
  Eigen::Matrix3Xd y_;
};

struct AsRigidAsPossibleOptions {
  int iterations = 2;      // maximum number of local and global iterations per step, >= 1
  double accuracy = 1e-6;  // m, a step ends if an iteration moves no node by more
};

/// As-rigid-as-possible shape (Sorkine and Alexa, Symposium on Geometry Processing 2007): purely
/// geometric baseline for the mechanical models. The cell of a node consists of the edges to its
/// neighbours, here those of tetrahedra. With one rotation per cell, the free nodes minimise the
/// sum over nodes i and neighbours j of w_ij |x_i - x_j - R_i (p_i - p_j)|^2, p at rest,
/// alternately over the rotations (polar decomposition) and the positions (a graph Laplacian,
/// factored in advance for each set of held grasps). No iteration increases the sum. Weights:
/// cotangents of tetrahedra, w_ij = -V grad phi_i . grad phi_j summed over those at the edge, which
/// makes the result independent of the mesh where it is fine; bounded below by a thousandth of the
/// largest, so that the Laplacian remains definite.
///
/// No material, gravity, loads, velocity, reaction (all zero) or sensitivity. Without held or fixed
/// nodes the shape does not change.
class AsRigidAsPossible final : public elasticity::ComparisonModel {
 public:
  /// Throws std::invalid_argument for an invalid body, element or option.
  explicit AsRigidAsPossible(elasticity::Body body, const AsRigidAsPossibleOptions& options = {});

  void reset() noexcept override;

  /// Value of the sum for the present shape with optimal rotations, m^3.
  double energy() noexcept;

 private:
  struct Edge {
    int a, b;              // nodes, a < b
    double weight;         // m
    Eigen::Vector3d rest;  // p_a - p_b
  };

  elasticity::StepReport advance(double dt) noexcept override;
  void rotate() noexcept;
  double relocate(LaplacianFactor& factor) noexcept;

  AsRigidAsPossibleOptions options_;
  std::vector<Edge> edges_;
  /// Scale of each cell, 1/m^3: normalises the matrix whose rotation is computed.
  std::vector<double> scales_;
  std::vector<LaplacianFactor> factors_;  // by set of held grasps
  std::vector<Eigen::Quaterniond> warm_;
  std::vector<Eigen::Matrix3d> cells_, rotations_;
  Eigen::Matrix3Xd rhs_;
};

}  // namespace palpate::baselines
