#pragma once

#include <Eigen/Geometry>

#include "core/elasticity/comparison/comparison_model.hpp"
#include "core/elasticity/comparison/laplacian_factor.hpp"

namespace palpate::elasticity {

struct AsRigidAsPossibleOptions {
  int iterations = 2;      // pairs of a local and a global step in a step at most, >= 1
  double accuracy = 1e-6;  // m, a step ends where an iteration moves no node further
};

/// As-rigid-as-possible shape (Sorkine and Alexa, Symposium on Geometry Processing 2007): geometry
/// alone, beside which mechanics must earn its place. The cell of a node is the edges to its
/// neighbours, here those of tetrahedra; with one rotation for each cell the free nodes take the
/// positions that make
///   sum over nodes i and neighbours j of w_ij |x_i - x_j - R_i (p_i - p_j)|^2,
/// p at rest, least: in turn by rotations (polar decomposition) and by positions (a graph
/// Laplacian, factored beforehand for each set of held grasps). Each of the two can only lower it.
/// Weights: cotangents of tetrahedra, w_ij = -V grad phi_i . grad phi_j summed over those at the
/// edge, which makes it independent of the mesh where that is fine; in O from below by a
/// thousandth of the largest, so that the Laplacian stays definite.
///
/// No material, gravity, loads, velocity, reaction (all zero) or sensitivity. Where nothing is held
/// or fixed the shape stays as it is.
class AsRigidAsPossible final : public ComparisonModel {
 public:
  /// Throws std::invalid_argument for an invalid body, element or option.
  explicit AsRigidAsPossible(Body body, const AsRigidAsPossibleOptions& options = {});

  void reset() noexcept override;

  /// Of the present shape with the rotations that fit it best, m^3.
  double energy() noexcept;

 private:
  struct Edge {
    int a, b;              // nodes, a < b
    double weight;         // m
    Eigen::Vector3d rest;  // p_a - p_b
  };

  StepReport advance(double dt) noexcept override;
  void rotate() noexcept;
  double relocate(LaplacianFactor& factor) noexcept;

  AsRigidAsPossibleOptions options_;
  std::vector<Edge> edges_;
  std::vector<double> scales_;  // of each cell, 1/m^3: makes what it is turned by of order one
  std::vector<LaplacianFactor> factors_;  // by set of held grasps
  std::vector<Eigen::Quaterniond> warm_;
  std::vector<Eigen::Matrix3d> cells_, rotations_;
  Eigen::Matrix3Xd rhs_;
};

}  // namespace palpate::elasticity
