#pragma once

#include "core/elasticity/incremental/nodal_motion.hpp"
#include "tests/bench/core/elasticity/contact_newton.hpp"

namespace palpate::bench {

struct PenaltyOptions {
  double stiffness = 2e4;  // N/m, of a point in contact: its penetration per force
  /// m, slip in a step below which friction grows linearly (Li et al. 2020).
  double slip = 1e-6;
  int iterations = 2;  // maximum number of corrections per step
};

/// The second formulation of contact: a smooth potential instead of inequalities. A point within an
/// obstacle is pushed out in proportion to its depth; friction is the derivative of a regularised
/// dissipation with the normal forces of the last step (lagged, Li et al. 2020). Both are
/// part of the potential that the quasi-Newton iteration minimises; their stiffness at the snapshot
/// is part of the loop's factor, and what has changed since is left to the secant pairs. Otherwise
/// as the model: stale factor rotated with the nodes, prediction by the last step's motion,
/// corrections halved while the potential rises.
class ContactPenalty {
 public:
  ContactPenalty(const ContactScene& scene, const PenaltyOptions& options);

  /// Step whose hand ends at `hand`.
  elasticity::StepReport step(const math::Pose& hand);
  /// Takes the snapshot of a new factor; run() computes it outside the loop.
  void snapshot();
  void run();
  void install();

  const Eigen::Matrix3Xd& positions() { return parts_.positions(); }
  /// Contacts as the reference solver takes them: with the forces of the last step, and anchored
  /// where they are, since this friction counts slip from the beginning of the step.
  std::vector<elasticity::SurfaceContact> contacts() const;
  int pressing() const;
  double deepest() const;  // m

 private:
  struct Point {
    elasticity::SurfaceContact contact;
    double normal_force = 0;                          // N, lagged
    Eigen::Vector3d begin = Eigen::Vector3d::Zero();  // m, where the step began
  };

  double evaluate();
  void evaluate(Point& point);
  Eigen::Matrix3d stiffness(const Point& point) const;
  void add_stiffness(const Point& point);
  void find_correction();
  double slope() const;

  PenaltyOptions own_;
  ContactParts parts_;
  std::vector<Point> points_, at_snapshot_;
  elasticity::NodalField gradient_, gradient_before_, x_before_;
  elasticity::NodalMotion motion_;
  Eigen::Matrix3Xd x_snapshot_;
  Eigen::VectorXf correction_, step_taken_, force_change_;
  int steps_ = 0;
  double energy_ = 0;  // J, of the points as last evaluated
};

}  // namespace palpate::bench
