#pragma once

#include "core/math/random.hpp"
#include "core/published_sensing/cloud_estimator.hpp"
#include "core/published_sensing/voxel_lattice.hpp"

namespace palpate::published_sensing {

/// Masses and springs whose numbers evolve: V. E. Arriola-Rios and J. L. Wyatt, "A multimodal model
/// of object deformation under robotic pushing", IEEE Transactions on Cognitive and Developmental
/// Systems 2017 (thesis [38]).
///
/// Consumes: vision, the hand's pose (the paper knows its finger's), mesh, clamp, direction of
/// gravity; no E, nu or density. No probes of its own: what the hand does is the experiment.
/// Kept: a mass-spring model whose numbers an evolutionary algorithm finds, so that the predicted
/// shape meets the seen one; prediction of what is not seen by that model.
/// Left out: two dimensions (here a lattice in three, since the plant moves in three); the plastic
/// part of the model (the plant's foams have none); the prediction of the finger's force, which
/// no other method of the table is scored on; the paper evolves off line, generation after
/// generation over one recording. Here a population of models runs beside each other in the loop
/// and the worst is replaced, after each `generation` seconds, by a child of the best ones.
///
/// Genes, as logarithms: springs of face diagonals and of voxel diagonals over those of edges, and
/// weight over springs.
class EvolvedMassSpring final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    Options() { hand = true; }
    double voxel = 0.03;      // m
    int population = 6;       // at least 3
    double generation = 0.5;  // s
    double mutation = 0.4;    // deviation of a gene of a child
    double damping = 0.03;    // share of a velocity that is lost in a tick, in (0, 1)
  };
  using Genes = Eigen::Vector3d;

  /// Throws std::invalid_argument where an option is out of range.
  EvolvedMassSpring(const elasticity::Body& body, const mesh::Surface& surface,
                    const Options& options);

  const Genes& genes() const noexcept { return creatures_[best_].genes; }
  int generations() const noexcept { return generations_; }

 private:
  struct Creature {
    Genes genes = Genes::Zero();
    double squared = 0;  // m^2, summed over clouds of this generation
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
  double edge_;  // m, of a voxel, by which weight is measured
  int best_ = 0, generations_ = 0;
  double since_ = 0;  // s, from the last generation
  Eigen::Matrix3Xd force_, pull_;
};

}  // namespace palpate::published_sensing
