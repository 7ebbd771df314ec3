#include "core/published_sensing/voxel_mass_spring.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace palpate::published_sensing {

using Eigen::Array3d;
using Eigen::Array3i;
using Eigen::Vector3d;

VoxelMassSpring::VoxelMassSpring(const elasticity::Body& body, const mesh::Surface& surface,
                                 const Options& options)
    : CloudEstimator(body, surface, options), options_(options) {
  if (!(options.voxel > 0) || !(options.stiffness > 0) || !(options.damping > 0) ||
      !(options.damping < 1))
    throw std::invalid_argument("voxels want side and stiffness > 0, damping in (0, 1)");
  build(body);
  shape_ = body.mesh.nodes;
  still_.setZero(3, shape_.cols());
  pull_.setZero(3, shape_.cols());
  for (std::size_t g = 0; g < body.grasps.size(); ++g) held_[g] = body.grasps[g].nodes;
}

/// The lattice's nodes are those of voxels that hold a node of the mesh, or lie within it.
void VoxelMassSpring::build(const elasticity::Body& body) {
  const Eigen::Matrix3Xd& nodes = body.mesh.nodes;
  const Array3d lower = nodes.rowwise().minCoeff(),
                size = nodes.rowwise().maxCoeff().array() - lower;
  const Array3i cells = (size / options_.voxel).round().max(1.0).cast<int>();
  if ((cells + 1).cast<double>().prod() > 20000)
    throw std::invalid_argument("voxels are too small: more than 20000 nodes");
  const Array3d side = size / cells.cast<double>();
  const mesh::PointLocator locator(body.mesh);
  std::map<std::array<int, 3>, int> index;
  const auto node_at = [&](const Array3i& at) {
    return index.try_emplace({at[0], at[1], at[2]}, static_cast<int>(index.size())).first->second;
  };
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        const Array3i at(i, j, k);
        const Vector3d centre = lower + side * (at.cast<double>() + 0.5);
        if (locator.locate(centre).outside > 0.5 * side.minCoeff()) continue;
        for (int corner = 0; corner < 8; ++corner)
          node_at(at + Array3i(corner & 1, corner >> 1 & 1, corner >> 2));
      }
  for (Eigen::Index n = 0; n < nodes.cols(); ++n) {
    const Array3d local = (nodes.col(n).array() - lower) / side;
    const Array3i at = local.floor().cast<int>().min(cells - 1).max(0);
    const Array3d t = local - at.cast<double>();
    Embedding embedding;
    for (int corner = 0; corner < 8; ++corner) {
      const Array3i bit(corner & 1, corner >> 1 & 1, corner >> 2);
      embedding.nodes[corner] = node_at(at + bit);
      embedding.weights[corner] = bit.cast<double>().cwiseEqual(1).select(t, 1 - t).prod();
    }
    embeddings_.push_back(embedding);
  }
  const auto count = static_cast<Eigen::Index>(index.size());
  rest_.setZero(3, count);
  mass_.setZero(count);
  for (const auto& [at, node] : index)
    rest_.col(node) = lower + side * Array3d(at[0], at[1], at[2]);
  for (const auto& [at, node] : index)
    for (int step = 14; step < 27; ++step) {  // half of the 26 neighbours
      const auto other =
          index.find({at[0] + step % 3 - 1, at[1] + step / 3 % 3 - 1, at[2] + step / 9 - 1});
      if (other == index.end()) continue;
      springs_.push_back(
          {node, other->second, (rest_.col(node) - rest_.col(other->second)).norm()});
      mass_[node] += 1;
      mass_[other->second] += 1;
    }
  for (const int node : body.fixed_nodes)
    for (int corner = 0; corner < 8; ++corner)
      if (embeddings_[node].weights[corner] > 0.5)
        fixed_.push_back(embeddings_[node].nodes[corner]);
  std::sort(fixed_.begin(), fixed_.end());
  fixed_.erase(std::unique(fixed_.begin(), fixed_.end()), fixed_.end());
  lattice_ = rest_;
  velocity_.setZero(3, count);
  force_.setZero(3, count);
}

void VoxelMassSpring::begin(const Eigen::Matrix3Xd&) noexcept {
  lattice_ = rest_;
  velocity_.setZero();
  embed();
}

void VoxelMassSpring::embed() noexcept {
  for (std::size_t n = 0; n < embeddings_.size(); ++n) {
    Vector3d p = Vector3d::Zero();
    for (int k = 0; k < 8; ++k)
      p += embeddings_[n].weights[k] * lattice_.col(embeddings_[n].nodes[k]);
    shape_.col(static_cast<Eigen::Index>(n)) = p;
  }
}

/// In ticks and lattice springs: a step of 1, springs of stiffness 1, masses twice the sum of a
/// node's springs, so that no mode is faster than the step.
elasticity::StepReport VoxelMassSpring::advance(double, const estimation::EstimationInputs&,
                                                elasticity::DeformationModel& model) noexcept {
  pull_.setZero();
  pull_to_cloud(matches(), options_.stiffness * 20, 0, shape_, still_, pull_);
  const int grasps = uses_hand() ? static_cast<int>(model.body().grasps.size()) : 0;
  for (int g = 0; g < grasps; ++g) {
    if (!model.is_held(g)) continue;
    for (const int node : held_[g])
      pull_.col(node) = 20 * (held_place(g, node, model.body()) - shape_.col(node));
  }
  force_.setZero();
  for (std::size_t n = 0; n < embeddings_.size(); ++n)
    for (int k = 0; k < 8; ++k)
      force_.col(embeddings_[n].nodes[k]) +=
          embeddings_[n].weights[k] * pull_.col(static_cast<Eigen::Index>(n));
  for (const Spring& s : springs_) {
    const Vector3d d = lattice_.col(s.a) - lattice_.col(s.b);
    const Vector3d f = (1 - s.length / std::max(d.norm(), 1e-9)) * d;
    force_.col(s.a) -= f;
    force_.col(s.b) += f;
  }
  for (Eigen::Index i = 0; i < lattice_.cols(); ++i) {
    velocity_.col(i) = (1 - options_.damping) * (velocity_.col(i) + force_.col(i) / (2 * mass_[i]));
    lattice_.col(i) += velocity_.col(i);
  }
  for (const int node : fixed_) {
    lattice_.col(node) = rest_.col(node);
    velocity_.col(node).setZero();
  }
  embed();
  return carry(shape_, model);
}

}  // namespace palpate::published_sensing
