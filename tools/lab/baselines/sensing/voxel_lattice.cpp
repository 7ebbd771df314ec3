#include "tools/lab/baselines/sensing/voxel_lattice.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "core/mesh/point_locator.hpp"

namespace palpate::baselines {

using Eigen::Array3d;
using Eigen::Array3i;
using Eigen::Vector3d;

/// The lattice consists of the voxels that contain a node of the mesh or lie inside it.
VoxelLattice::VoxelLattice(const elasticity::Body& body, double voxel) {
  if (!(voxel > 0)) throw std::invalid_argument("voxels want a side above 0");
  const Eigen::Matrix3Xd& nodes = body.mesh.nodes;
  const Array3d lower = nodes.rowwise().minCoeff(),
                size = nodes.rowwise().maxCoeff().array() - lower;
  const Array3i cells = (size / voxel).round().max(1.0).cast<int>();
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
  for (const auto& [at, node] : index)
    rest_.col(node) = lower + side * Array3d(at[0], at[1], at[2]);
  for (const auto& [at, node] : index)
    for (int step = 14; step < 27; ++step) {  // half of the 26 neighbours
      const int way = (step % 3 != 1) + (step / 3 % 3 != 1) + (step / 9 != 1);
      const auto other =
          index.find({at[0] + step % 3 - 1, at[1] + step / 3 % 3 - 1, at[2] + step / 9 - 1});
      if (other == index.end()) continue;
      springs_.push_back(
          {node, other->second, (rest_.col(node) - rest_.col(other->second)).norm(), way - 1});
    }
  for (const int node : body.fixed_nodes)
    for (int corner = 0; corner < 8; ++corner)
      if (embeddings_[node].weights[corner] > 0.5)
        fixed_.push_back(embeddings_[node].nodes[corner]);
  std::sort(fixed_.begin(), fixed_.end());
  fixed_.erase(std::unique(fixed_.begin(), fixed_.end()), fixed_.end());
}

void VoxelLattice::embed(const Eigen::Matrix3Xd& lattice, Eigen::Matrix3Xd& shape) const noexcept {
  for (std::size_t n = 0; n < embeddings_.size(); ++n) {
    Vector3d p = Vector3d::Zero();
    for (int k = 0; k < 8; ++k)
      p += embeddings_[n].weights[k] * lattice.col(embeddings_[n].nodes[k]);
    shape.col(static_cast<Eigen::Index>(n)) = p;
  }
}

void VoxelLattice::spread(const Eigen::Matrix3Xd& on_mesh,
                          Eigen::Matrix3Xd& on_lattice) const noexcept {
  for (std::size_t n = 0; n < embeddings_.size(); ++n)
    for (int k = 0; k < 8; ++k)
      on_lattice.col(embeddings_[n].nodes[k]) +=
          embeddings_[n].weights[k] * on_mesh.col(static_cast<Eigen::Index>(n));
}

}  // namespace palpate::baselines
