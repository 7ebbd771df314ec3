#pragma once

#include <Eigen/Geometry>

#include "core/elasticity/comparison/comparison_model.hpp"

namespace palpate::elasticity {

struct ShapeMatchingOptions {
  int rings = 1;         // of mesh edges round each node that its region reaches, in [1, 5]
  int max_substeps = 8;  // that a step may be split into to be as stiff as E says, >= 1
};

/// Meshless shape matching (Mueller, Heidelberger, Teschner and Gross, SIGGRAPH 2005) with one
/// region round each node as in lattice shape matching (Rivers and James, SIGGRAPH 2007): nodes
/// move freely, each region finds the rigid pose of its rest shape nearest to them, and they are
/// drawn towards it by a share alpha, the correction of a node being the mean of its regions'
/// (weights w = 1 / number of its regions). Grasped and fixed nodes are prescribed, loads are
/// accelerations. Linear and angular momentum of each correction are zero.
///
/// Stiffness: a region drawn by alpha = k h^2 stores the energy k/2 sum w m |x - goal|^2. Equated,
/// in the mean over all small uniform strains, with mu V |F - R|^2, the co-rotated energy of a
/// material with nu = 0 and E = 2 mu, it gives k; where the region's moments are alike along all
/// axes,
///   k = 3 E V / J,  J = sum w m |r|^2,  V the region's share of the volume.
/// alpha may not exceed 1, so nothing stiffer than J / (3 V h^2) can be had from a step h; hence
/// the substeps, and modulus_share() where they do not suffice.
///
/// What it cannot do: nu is 0 whatever the material says; volume is not kept; in regions long
/// in one direction, and at the surface, E is met on average only; stiffness-proportional damping
/// is replaced by the scheme's own, which is that of a stiffness factor equal to h; it has
/// neither residual (reported as zero) nor sensitivity. On a quadratic mesh all nodes take part,
/// joined as in linear_pieces().
class ShapeMatchingModel final : public ComparisonModel {
 public:
  /// Throws std::invalid_argument for an invalid body, element or option.
  explicit ShapeMatchingModel(Body body, const ShapeMatchingOptions& options = {});

  void reset() noexcept override;

  const Eigen::VectorXd& masses() const noexcept { return masses_; }  // kg, by node

  /// Substeps that a step of dt seconds is split into.
  int substeps(double dt) const noexcept;

  /// Share of E that the stiffest region realises at steps of dt seconds; 1 where all is well.
  double modulus_share(double dt) const noexcept;

 private:
  struct Member {
    int node;
    double weight;         // w
    double mass;           // w m, kg
    Eigen::Vector3d rest;  // from the region's centre of mass, m
  };
  struct Region {
    int begin, end;    // members
    double mass;       // kg, of its members by weight
    double scale;      // 1/(kg m^2), makes its moment of the order of one
    double stiffness;  // k, 1/s^2
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // warm start
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
