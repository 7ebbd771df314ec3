#pragma once

#include "core/published_sensing/cloud_estimator.hpp"
#include "core/published_sensing/voxel_lattice.hpp"

namespace palpate::published_sensing {

/// Masses and springs on a lattice of voxels, drawn along by a camera's cloud: I. Leizea,
/// H. Alvarez, I. Aguinaga and D. Borro, "Real-time deformation, registration and tracking of
/// solids based on physical simulation", ISMAR 2014 (thesis [30]).
///
/// Consumes: vision, model (mesh, clamp). Not the hand's pose, unless `hand`. No probes. Stiffness
/// counts against that of the cloud's springs alone, so that E, nu and density are not used.
/// Kept: voxels instead of the object's own elements; springs along edges and diagonals of voxels;
/// the displacement between the surface and what is seen of it as force on the lattice, integrated
/// in time; the mesh embedded in the lattice (trilinear).
/// Left out: the initial registration (the rest shape's place is known here); the paper's own
/// relation of spring constants to E and nu, and gravity, whose effect the cloud shows. Masses are
/// such that a step of the loop is stable (each node's is the sum of its springs' stiffness).
class VoxelMassSpring final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    double voxel = 0.03;     // m, side, rounded so that whole voxels fill the object's box
    double stiffness = 0.3;  // of the cloud's springs together over that of one lattice edge
    double damping = 0.03;   // share of a velocity that is lost in a tick, in (0, 1)
  };

  /// Throws std::invalid_argument where an option is out of range, or the lattice beyond 20000
  /// nodes.
  VoxelMassSpring(const elasticity::Body& body, const mesh::Surface& surface,
                  const Options& options);

  int lattice_size() const noexcept { return static_cast<int>(lattice_.cols()); }  // nodes

 private:
  void begin(const Eigen::Matrix3Xd& positions) noexcept override;
  elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                 elasticity::DeformationModel& model) noexcept override;

  Options options_;
  VoxelLattice voxels_;
  Eigen::Matrix3Xd lattice_, velocity_, force_;
  Eigen::VectorXd mass_;                   // of springs
  Eigen::Matrix3Xd shape_, still_, pull_;  // at the mesh's nodes
};

}  // namespace palpate::published_sensing
