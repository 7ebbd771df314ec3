#include "tools/lab/baselines/sensing/voxel_mass_spring.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::baselines {
namespace {

using Eigen::Vector3d;

// Stiffness of the cloud's and the hand's springs relative to a lattice edge.
constexpr double kSpringScale = 20;

}  // namespace

VoxelMassSpring::VoxelMassSpring(const elasticity::Body& body, const mesh::Surface& surface,
                                 const Options& options)
    : CloudEstimator(body, surface, options), options_(options), voxels_(body, options.voxel) {
  if (!(options.stiffness > 0) || !(options.damping > 0) || !(options.damping < 1))
    throw std::invalid_argument("voxels want stiffness > 0, damping in (0, 1)");
  lattice_ = voxels_.rest();
  velocity_.setZero(3, lattice_.cols());
  force_.setZero(3, lattice_.cols());
  mass_.setZero(lattice_.cols());
  for (const VoxelLattice::Spring& s : voxels_.springs()) {
    mass_[s.a] += 1;
    mass_[s.b] += 1;
  }
  shape_ = body.mesh.nodes;
  still_.setZero(3, shape_.cols());
  pull_.setZero(3, shape_.cols());
}

void VoxelMassSpring::begin(const Eigen::Matrix3Xd&) noexcept {
  lattice_ = voxels_.rest();
  velocity_.setZero();
  voxels_.embed(lattice_, shape_);
}

/// In units of ticks and lattice springs: step 1, spring stiffness 1, masses twice the sum of a
/// node's spring stiffnesses, so that no mode is faster than the step.
elasticity::StepReport VoxelMassSpring::advance(double, const estimation::EstimationInputs&,
                                                elasticity::DeformationModel& model) noexcept {
  const elasticity::Body& body = model.body();
  pull_.setZero();
  pull_to_cloud(matches(), options_.stiffness * kSpringScale, 0, shape_, still_, pull_);
  for (int g = 0; uses_hand() && g < static_cast<int>(body.grasps.size()); ++g) {
    if (!model.is_held(g)) continue;
    for (const int node : body.grasps[g].nodes)
      pull_.col(node) = kSpringScale * (held_place(g, node, body) - shape_.col(node));
  }
  force_.setZero();
  voxels_.spread(pull_, force_);
  for (const VoxelLattice::Spring& s : voxels_.springs()) {
    const Vector3d d = lattice_.col(s.a) - lattice_.col(s.b);
    const Vector3d f = (1 - s.length / std::max(d.norm(), 1e-9)) * d;
    force_.col(s.a) -= f;
    force_.col(s.b) += f;
  }
  for (Eigen::Index i = 0; i < lattice_.cols(); ++i) {
    velocity_.col(i) = (1 - options_.damping) * (velocity_.col(i) + force_.col(i) / (2 * mass_[i]));
    lattice_.col(i) += velocity_.col(i);
  }
  for (const int node : voxels_.fixed()) {
    lattice_.col(node) = voxels_.rest().col(node);
    velocity_.col(node).setZero();
  }
  voxels_.embed(lattice_, shape_);
  return carry(shape_, model);
}

}  // namespace palpate::baselines
