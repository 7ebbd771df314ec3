#pragma once

#include "core/math/random.hpp"
#include "tools/lab/baselines/sensing/cloud_estimator.hpp"
#include "tools/lab/baselines/sensing/voxel_lattice.hpp"

namespace palpate::baselines {

/// Mass-spring model with evolved parameters: V. E. Arriola-Rios and J. L. Wyatt, "A multimodal
/// model of object deformation under robotic pushing", IEEE Transactions on Cognitive and
/// Developmental Systems 2017 (Sanchez 2019, Table 2.1 [38]).
///
/// Consumes: vision, pose of the hand (in the paper that of a finger), mesh, clamp, direction of
/// gravity; no E, nu or density. No dedicated probing motions: the motion of the hand is the
/// experiment. Kept: a mass-spring model whose parameters an evolutionary algorithm determines such
/// that the predicted shape matches the observed one; prediction of unobserved parts by that model.
/// Left out: the restriction to two dimensions (here a 3-D lattice, because the plant moves in
/// three); the plastic part of the model (the plant's foams have none); the prediction of the
/// finger's force, on which no other method is evaluated. The paper evolves offline, over many
/// generations on one recording. Here a population of models runs concurrently in the loop, and the
/// worst one is replaced every `generation` seconds by a child of the best ones.
///
/// Genes, as logarithms: stiffness of face diagonals and of voxel diagonals relative to edges, and
/// weight relative to stiffness.
class EvolvedMassSpring final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    Options() { hand = true; }
    double voxel = 0.03;      // m
    int population = 6;       // at least 3
    double generation = 0.5;  // s
    double mutation = 0.4;    // standard deviation of a child's gene
    double damping = 0.03;    // fraction of a velocity lost per tick, in (0, 1)
  };
  using Genes = Eigen::Vector3d;

  /// Throws std::invalid_argument if an option is out of range.
  EvolvedMassSpring(const elasticity::Body& body, const mesh::Surface& surface,
                    const Options& options);

  const Genes& genes() const noexcept { return creatures_[best_].genes; }
  int generations() const noexcept { return generations_; }

 private:
  struct Creature {
    Genes genes = Genes::Zero();
    double squared = 0;  // m^2, summed over the clouds of this generation
    int looks = 0;
    Eigen::Matrix3Xd lattice, velocity, shape;
  };
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  void take(elasticity::DeformationModel& model) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;
  void live(Creature& creature, const elasticity::DeformationModel& model) noexcept;
  void breed() noexcept;

  Options options_;
  VoxelLattice voxels_;
  std::vector<Creature> creatures_;
  math::Random random_;
  Eigen::Vector3d down_ = Eigen::Vector3d::Zero();
  double edge_;  // m, edge of a voxel, the unit of the weight
  int best_ = 0, generations_ = 0;
  double since_ = 0;  // s, since the last generation
  Eigen::Matrix3Xd force_, pull_;
};

}  // namespace palpate::baselines
