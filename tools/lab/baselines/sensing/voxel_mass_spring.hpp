#pragma once

#include "tools/lab/baselines/sensing/cloud_estimator.hpp"
#include "tools/lab/baselines/sensing/voxel_lattice.hpp"

namespace palpate::baselines {

/// Mass-spring model on a voxel lattice, driven by a camera's point cloud: I. Leizea, H. Alvarez,
/// I. Aguinaga and D. Borro, "Real-time deformation, registration and tracking of solids based on
/// physical simulation", ISMAR 2014 (Sanchez 2019, Table 2.1 [30]).
///
/// Consumes: vision, model (mesh, clamp). The pose of the hand only with `hand`. No probing
/// motions. Only the stiffness relative to the cloud's springs matters, therefore E, nu and density
/// are not used. Kept: voxels instead of the object's own elements; springs along edges and
/// diagonals of voxels; the displacement between the surface and its observation acts as a force on
/// the lattice, integrated in time; the mesh is embedded in the lattice (trilinear). Left out: the
/// initial registration (here the rest pose is known); the paper's relation of spring constants to
/// E and nu; gravity, whose effect is observed in the cloud. Masses are chosen such that a step of
/// the loop is stable (each node's is proportional to the sum of its springs' stiffnesses).
class VoxelMassSpring final : public CloudEstimator {
 public:
  struct Options : CloudEstimator::Options {
    /// m, edge length, rounded so that an integer number of voxels fills the object's box
    double voxel = 0.03;
    double stiffness = 0.3;  // total stiffness of the cloud's springs relative to one lattice edge
    double damping = 0.03;   // fraction of a velocity lost per tick, in (0, 1)
  };

  /// Throws std::invalid_argument if an option is out of range, or the lattice has more than 20000
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
  Eigen::VectorXd mass_;                   // sums of spring stiffnesses
  Eigen::Matrix3Xd shape_, still_, pull_;  // at the mesh's nodes
};

}  // namespace palpate::baselines
