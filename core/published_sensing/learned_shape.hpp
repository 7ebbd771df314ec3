#pragma once

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/published_sensing/shape_network.hpp"

namespace palpate::published_sensing {

/// A shape that a network tells from what the hand feels and where it is. Two published methods:
///
/// `position`: A.-M. Cretu, P. Payeur and E. M. Petriu, "Soft object deformation monitoring and
/// learning for model-based robotic hand manipulation", IEEE Transactions on Systems, Man, and
/// Cybernetics B 2012 (thesis [28]): kept are growing neural gas on the object's contour, and a
/// feed-forward network from force and fingers' position to the units' places.
/// Inputs: force (3) and place of the hand (3).
/// `angle`: B. Tawbe and A.-M. Cretu, "Acquisition and neural network prediction of 3D deformable
/// object shape using a Kinect and a force-torque sensor", Sensors 2017 (thesis [37]): kept are the
/// object's points clustered by a neural gas, a network from magnitude of the force, its angle and
/// place.
/// Inputs: magnitude of the force (1), rotation vector of the hand (3), its place (3).
///
/// Consumes: the wrench, the hand's pose, mesh; and recordings of the object's shape under other
/// motions, which it is trained on (palpate-evaluate train-sensing, where the truth stands for the
/// papers' camera and scanner). No probes in the run itself.
/// Left out: the image processing of both papers that yields the contour, so that [28]'s contour in
/// the picture becomes the surface in space; [37]'s network for each cluster is one with as many
/// outputs. Nodes between the units move by what those near them do.
class LearnedShape final : public estimation::Estimator {
 public:
  enum class Inputs { kPosition, kAngle };
  struct Model {
    Inputs inputs = Inputs::kPosition;
    Eigen::Matrix3Xd units;  // at rest, m
    ShapeNetwork network;    // to the displacements of the units, x, y, z one unit after the other
  };

  static Eigen::Index input_count(Inputs inputs) noexcept {
    return inputs == Inputs::kPosition ? 6 : 7;
  }
  /// What the network is given of a hand.
  static void gather(Inputs inputs, const Eigen::Vector3d& force_O, const math::Pose& X_OG,
                     const math::Pose& X_OG_rest, Eigen::VectorXd& into) noexcept;

  /// `average`: s, time constant of the filter of the force. Throws std::invalid_argument where the
  /// model does not agree with itself, nothing holds the body, or `average` is not positive.
  LearnedShape(const elasticity::Body& body, const Model& model, double average);

  void activate(elasticity::DeformationModel& model) noexcept override;
  /// Degraded while the hand's wrench or pose lacks.
  sensing::UpdateResult update(const estimation::EstimationInputs& inputs,
                               elasticity::DeformationModel& model,
                               estimation::Estimate& estimate) noexcept override;
  void reset() noexcept override;

 private:
  Model model_;
  double average_;
  math::Pose rest_pose_;
  Eigen::MatrixXd spread_;  // mesh nodes x units
  Eigen::VectorXd input_, room_, output_;
  Eigen::Matrix3Xd rest_, shape_, still_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  bool felt_ = false;
  estimation::StepGuard step_guard_;
};

}  // namespace palpate::published_sensing
