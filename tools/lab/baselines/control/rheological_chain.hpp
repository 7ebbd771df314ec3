#pragma once

#include "core/elasticity/body.hpp"

namespace palpate::baselines {

/// Cocuzza and Yan, motion planning for shaping a rheological object: row [53] of Table 2.2 in
/// Sanchez 2019.
///
/// Consumes: the object's size, stiffness and density, two relaxation parameters (of a material
/// test), the target in advance, the pose of the hand; never the shape. Kept: a chain of masses
/// whose links are three-element models (a spring in parallel with a spring and dashpot in series),
/// in stretch and bending; the motion of the hand is simulated in time, and the motion is planned
/// after which, once the object has crept, the points are at their target; executed in open loop.
/// Left out: the removal of the tool and the residual shape (here the hand keeps holding), the
/// restriction to a plane (here the chain bends in space), their tensile test (the two parameters
/// are tuned as those of the other baselines). Masses are assumed quasi-static, which holds for
/// foam. Based on summaries of the work.
class RheologicalChain {
 public:
  struct Options {
    int masses = 16;  // 6 to 60, from the clamp to the hand
    /// Stiffness of the Maxwell spring relative to the parallel spring, >= 0.
    double relaxation = 0.5;
    double relaxation_time = 2;  // s
  };

  /// Throws std::invalid_argument if an option is out of range, or the body is not fixed at one end
  /// and held at the other by grasp `grasp`.
  RheologicalChain(const Options& options, const elasticity::Body& body, int grasp);

  /// Resets to the rest state: straight except for gravity, fully relaxed.
  void reset();

  /// Moves the hand to X_OG during dt s. False if no equilibrium was found.
  bool step(const math::Pose& X_OG, double dt);

  /// Present positions of the points of the object that were at `rest_points` (in O, m) at rest.
  Eigen::VectorXd points(const std::vector<Eigen::Vector3d>& rest_points) const;

  const Eigen::Matrix3Xd& masses() const { return x_; }

 private:
  int count() const { return static_cast<int>(x_.cols()); }
  int free_count() const { return count() - 4; }
  void set_ends(const math::Pose& X_OG);
  double energy(double share) const;
  void derivatives(double share, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const;
  Eigen::Vector3d curvature(int i) const { return x_.col(i + 1) - 2 * x_.col(i) + x_.col(i - 1); }
  double stretch(int i) const { return (x_.col(i + 1) - x_.col(i)).norm() - link_; }

  Options options_;
  math::Pose X_rest_;
  Eigen::Vector3d along_, weight_;  // direction of the axis; N, weight of one mass
  double link_ = 0;                 // m, between two masses at rest
  double stretching_ = 0;           // N/m, spring of a link
  Eigen::Vector3d bending_;         // N/m, by direction of the curvature, in O
  Eigen::Matrix3Xd rest_, x_;
  Eigen::VectorXd stretch_crept_;   // m, by link
  Eigen::Matrix3Xd bending_crept_;  // m, by mass
  double torsion_ = 0;              // rad, rotation of the hand about the axis
};

}  // namespace palpate::baselines
