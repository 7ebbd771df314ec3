#pragma once

#include "core/elasticity/body.hpp"

namespace palpate::published_control {

/// Cocuzza and Yan, planning the shape of a rheological object: row [53].
///
/// Consumes: the object's size, stiffness and density, two numbers of its relaxation (of a material
/// test), the target beforehand, the hand's pose; never the shape. Kept: a chain of masses whose
/// links are three-element ones, a spring beside a spring and a dashpot in series, in stretch and
/// bending; a motion of the hand is simulated in time, and that one is planned after which, once
/// the object has crept, the points are at their target; carried out in open loop. Left out: the
/// tool's departure and what remains then (every hand here holds on), the plane (the chain bends in
/// space), their tensile test (the two numbers are tuned as everybody's are). Masses are taken to
/// be at rest in every step, since an object of foam is. Written from summaries of the work.
class RheologicalChain {
 public:
  struct Options {
    int masses = 16;             // 6 to 60, from the clamp to the hand
    double relaxation = 0.5;     // of the Maxwell spring's stiffness to the other's, >= 0
    double relaxation_time = 2;  // s
  };

  /// Throws std::invalid_argument where an option is out of range, or the body is not held at one
  /// end by a rig and at another by grasp `grasp`.
  RheologicalChain(const Options& options, const elasticity::Body& body, int grasp);

  /// As at rest: straight but for gravity, crept for ever.
  void reset();

  /// The hand moves to X_OG, and dt s pass. False where no equilibrium was found.
  bool step(const math::Pose& X_OG, double dt);

  /// Where points of the object are, that were at `rest_points` (in O, m) at rest.
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
  Eigen::Vector3d along_, weight_;  // of the axis; N, of one mass
  double link_ = 0;                 // m, between two masses at rest
  double stretching_ = 0;           // N/m, of the spring of a link
  Eigen::Vector3d bending_;         // N/m, by the direction of the curvature, in O
  Eigen::Matrix3Xd rest_, x_;
  Eigen::VectorXd stretch_crept_;   // m, by link
  Eigen::Matrix3Xd bending_crept_;  // m, by mass
  double torsion_ = 0;              // rad, of the hand about the axis
};

}  // namespace palpate::published_control
