#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/control/control_law.hpp"

namespace palpate::baselines {

/// Jacobian by finite differences of another deformation model of the same object: seven copies of
/// it follow the hand, six of them displaced slightly along and about each axis of O, and J
/// consists of the differences of their shapes. One copy is updated per tick, in turn, and all
/// seven for the same pose of the hand, so that a tick costs one step and J is 7 to 14 ticks old.
/// The models use linear tetrahedra on the corners of the body's mesh; a midside node moves as the
/// mean of its corners.
///
/// Used by two methods of the literature:
/// - as_rigid_as_possible: Shetab-Bushehri, Aranda, Mezouar and Ozgur, "As-rigid-as-possible shape
///   servoing", IEEE Robotics and Automation Letters 7(2), 2022. Consumes: rest shape, pose of the
///   hand, feature values (vision); no mechanical parameters, no probing motions. Kept: the shape
///   of an elastic object minimises the ARAP energy under the pose of the hand, and the Jacobian is
///   that of this minimum. Left out: the analytic form (here differences of converged minima, equal
///   to 1e-3), tracking of the surface by an RGB-D camera.
/// - mass_spring: Makiyeh, Marchal, Chaumette and Krupa, "Indirect positioning of a 3D point on a
///   soft object using RGB-D visual servoing and a mass-spring model", ICARCV 2022. Consumes: rest
///   shape, a stiffness (relevant only relative to gravity), hand and feature (vision). Kept: a
///   coarse spring network provides J. Left out: its analytic form, their choice of parameters, the
///   Fourier surface of the later paper.
class DifferenceJacobian final : public control::JacobianProvider {
 public:
  /// Creates one copy of the model of a body.
  using Factory =
      std::function<std::unique_ptr<elasticity::DeformationModel>(const elasticity::Body&)>;
  struct Options {
    double distance = 2e-3;  // m, displacement of a copy
    double angle = 0.01;     // rad, rotation of a copy
    double dt = 1e-3;        // s, step of a model; large if inertia must not matter
    int first_steps = 200;   // steps of each copy in the constructor, before the first J
  };
  /// Throws std::invalid_argument if the body has no grasp `grasp`. Steps the models: slow.
  DifferenceJacobian(const Options& options, const elasticity::Body& body, int grasp,
                     const Factory& factory);

  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;

  /// Steps all copies `steps` times with the hand at X_OG.
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
  std::vector<Parents> parents_;  // parents of every node; a corner is its own parent
  std::vector<std::unique_ptr<elasticity::DeformationModel>> models_;  // the undisplaced copy first
  math::Pose X_round_;         // pose of the hand for which the copies are being updated
  Eigen::MatrixXd by_motion_;  // 3 x corners rows, 6 columns
  int next_ = 0;
};

/// The same body with linear tetrahedra on the corners of its mesh.
elasticity::Body corner_body(const elasticity::Body& body);

}  // namespace palpate::baselines
