#pragma once

#include <string>

#include "tools/lab/baselines/learning/shape_network.hpp"
#include "tools/lab/baselines/learning/shape_predictor.hpp"

namespace palpate::baselines {

/// Shape predicted by a network from force and pose of the hand. Two published methods:
///
/// `position`: A.-M. Cretu, P. Payeur and E. M. Petriu, "Soft object deformation monitoring and
/// learning for model-based robotic hand manipulation", IEEE Transactions on Systems, Man, and
/// Cybernetics B 2012 (Sanchez 2019, Table 2.1 [28]): kept are growing neural gas on the object's
/// contour, and a feed-forward network from force and finger positions to the positions of its
/// units. Inputs of the network: force (3) and position of the hand (3).
/// `angle`: B. Tawbe and A.-M. Cretu, "Acquisition and neural network prediction of 3D deformable
/// object shape using a Kinect and a force-torque sensor", Sensors 2017 (Sanchez 2019, Table 2.1
/// [37]): kept are the object's points clustered by a neural gas, a network from magnitude, angle
/// and location of the force. Inputs of the network: magnitude of the force (1), rotation vector of
/// the hand (3), its position (3).
///
/// Consumes: the wrench, the pose of the hand, mesh; and recordings of the object's shape under
/// other motions for training (palpate-evaluate train-sensing, where the ground truth replaces the
/// papers' camera and scanner). No probing motions during the run. Left out: the image processing
/// of both papers that extracts the contour, so that the contour in the image of [28] becomes the
/// surface in space; the separate network per cluster of [37] is replaced by one with as many
/// outputs. Nodes between units follow the nearby units.
class LearnedShape final : public ShapePredictor {
 public:
  enum class Inputs { kPosition, kAngle };
  struct Model {
    Inputs inputs = Inputs::kPosition;
    Eigen::Matrix3Xd units;  // at rest, m
    /// Maps to the displacements of the units, x, y, z of one unit after the other.
    ShapeNetwork network;
  };

  static Eigen::Index input_count(Inputs inputs) noexcept {
    return inputs == Inputs::kPosition ? 6 : 7;
  }
  /// Writes the network's inputs for a hand to `into`.
  static void gather(Inputs inputs, const Eigen::Vector3d& force_O, const math::Pose& X_OG,
                     const math::Pose& X_OG_rest, Eigen::VectorXd& into) noexcept;

  /// `average`: s, time constant of the force filter. Throws std::invalid_argument if the model is
  /// inconsistent, the body has no grasp, or `average` is not positive.
  LearnedShape(const elasticity::Body& body, const Model& model, double average);

  void reset() noexcept override;

 private:
  /// Degraded while the hand's wrench or pose is missing.
  UpdateResult predict(const estimation::EstimationInputs& inputs, double step,
                       Eigen::Matrix3Xd& shape, estimation::Estimate& estimate) noexcept override;

  Model model_;
  double average_;
  math::Pose rest_pose_;
  Eigen::MatrixXd spread_;  // mesh nodes x units
  Eigen::VectorXd input_, room_, output_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  bool felt_ = false;
};

/// Reads a model written by palpate-evaluate train-sensing, YAML. Throws config::Error with file
/// and key.
LearnedShape::Model read_learned_shape(const std::string& file);

}  // namespace palpate::baselines
