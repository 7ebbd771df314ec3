#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/control/control_law.hpp"

namespace palpate::published_control {

/// The Jacobian that another deformation model of the same object gives under the same hand: seven
/// copies of it follow the hand, six of them displaced by a little along and about each axis of O,
/// and J is what their shapes differ by. One copy is brought up to date in a tick, in turn and all
/// seven for one pose of the hand, so that a tick costs one step and J is 7 to 14 ticks old. The
/// models have linear tetrahedra on the corners of the body's mesh; a midside node moves as the
/// mean of its corners do.
///
/// Two methods of the literature come of it:
/// - as_rigid_as_possible: Shetab-Bushehri, Aranda, Mezouar and Ozgur, "As-rigid-as-possible shape
///   servoing", IEEE Robotics and Automation Letters 7(2), 2022. Consumes: the shape at rest, the
///   hand's pose, feature values (vision); no mechanical parameters, no probes. Kept: an elastic
///   object's shape is the minimum of the ARAP energy under the hand, its Jacobian that of this
///   minimum. Left out: the analytic form (differences of converged minima here, equal to 1e-3),
///   the tracking of the surface by an RGB-D camera.
/// - mass_spring: Makiyeh, Marchal, Chaumette and Krupa, "Indirect positioning of a 3D point on a
///   soft object using RGB-D visual servoing and a mass-spring model", ICARCV 2022. Consumes: the
///   shape at rest, a stiffness (which matters only against gravity), hand and feature (vision).
///   Kept: a coarse network of springs gives J. Left out: its analytic form, their choice of
///   parameters, the surface by Fourier coefficients of the later paper.
class DifferenceJacobian final : public control::JacobianProvider {
 public:
  /// Makes one copy of the model of a body.
  using Factory =
      std::function<std::unique_ptr<elasticity::DeformationModel>(const elasticity::Body&)>;
  struct Options {
    double distance = 2e-3;  // m, of a copy's displacement
    double angle = 0.01;     // rad
    double dt = 1e-3;        // s, of a model's step; large where inertia is not to matter
    int first_steps = 200;   // of each copy when the first J is asked for in construction
  };
  /// Throws std::invalid_argument for a body without a grasp `grasp`. Steps the models: takes long.
  DifferenceJacobian(const Options& options, const elasticity::Body& body, int grasp,
                     const Factory& factory);

  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;

  /// All copies at once, `steps` times, with the hand there.
  void settle(const math::Pose& X_OG, int steps) noexcept;

 private:
  struct Parents {
    int a, b;  // corners
  };
  void advance(int copy, const math::Pose& X_OG) noexcept;
  void compare() noexcept;

  Options options_;
  int grasp_;
  int node_count_ = 0;
  std::vector<Parents> parents_;  // of every node; a corner is its own
  std::vector<std::unique_ptr<elasticity::DeformationModel>> models_;  // the undisplaced one first
  math::Pose X_round_;         // of the hand, for which the copies are being brought up to date
  Eigen::MatrixXd by_motion_;  // 3 x corners rows, 6 columns
  int next_ = 0;
};

/// The same body of linear tetrahedra on the corners of its mesh.
elasticity::Body corner_body(const elasticity::Body& body);

}  // namespace palpate::published_control
