#pragma once

#include <Eigen/Geometry>

#include "core/elasticity/comparison/comparison_model.hpp"

namespace palpate::elasticity {

struct ShapeMatchingOptions {
  int rings = 1;         // size of each node's region in rings of mesh edges, in [1, 5]
  int max_substeps = 8;  // maximum number of substeps used to realise Young's modulus, >= 1
};

/// Meshless shape matching (Mueller, Heidelberger, Teschner and Gross, SIGGRAPH 2005) with one
/// region around each node as in lattice shape matching (Rivers and James, SIGGRAPH 2007). Nodes
/// move freely; for each region the best-fitting rigid pose of its rest shape is computed, and its
/// nodes are moved towards it by a fraction alpha; a node's correction is the mean over its regions
/// (weights w = 1 / number of its regions). Grasped and fixed nodes are prescribed, loads are
/// accelerations. Corrections conserve linear and angular momentum.
///
/// Stiffness: a region moved by alpha = k h^2 stores the energy k/2 sum w m |x - goal|^2. Equating
/// it, in the mean over all small uniform strains, with mu V |F - R|^2, the co-rotated energy of a
/// material with nu = 0 and E = 2 mu, yields k; if the region's moments are equal along all axes,
///   k = 3 E V / J,  J = sum w m |r|^2,  V the region's share of the volume.
/// alpha must not exceed 1, so that a step h cannot realise a stiffness above J / (3 V h^2); hence
/// the substeps, and modulus_share() where they do not suffice.
///
/// Limitations: nu is 0 whatever the material; volume is not conserved; in elongated regions and at
/// the surface Young's modulus is met on average only; stiffness-proportional damping is replaced
/// by that of the scheme, equivalent to a stiffness factor of h; neither residual (reported as
/// zero) nor sensitivity are available. On a quadratic mesh all nodes take part, connected as in
/// linear_pieces().
class ShapeMatchingModel final : public ComparisonModel {
 public:
  /// Throws std::invalid_argument for an invalid body, element or option.
  explicit ShapeMatchingModel(Body body, const ShapeMatchingOptions& options = {});

  void reset() noexcept override;

  const Eigen::VectorXd& masses() const noexcept { return masses_; }  // kg, by node

  /// Number of substeps of a step of dt seconds.
  int substeps(double dt) const noexcept;

  /// Fraction of Young's modulus that the stiffest region realises for steps of dt seconds; 1 if it
  /// is fully realised.
  double modulus_share(double dt) const noexcept;

 private:
  struct Member {
    int node;
    double weight;         // w
    double mass;           // w m, kg
    Eigen::Vector3d rest;  // m, relative to the region's centre of mass
  };
  struct Region {
    int begin, end;    // range of members
    double mass;       // kg, weighted mass of its members
    double scale;      // 1/(kg m^2), normalises its moment matrix
    double stiffness;  // k, 1/s^2
    /// Starting point of the polar decomposition.
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  };

  StepReport advance(double dt) noexcept override;
  void correct(double square) noexcept;

  ShapeMatchingOptions options_;
  Eigen::VectorXd masses_;
  std::vector<Member> members_;
  std::vector<Region> regions_;
  double stiffest_ = 0;  // 1/s^2
  Eigen::Matrix3Xd x_target_, x_before_, acceleration_, correction_;
};

}  // namespace palpate::elasticity
