#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::baselines {

/// Few nodes distributed over a mesh, each with a rotation and a translation, blended over the mesh
/// between them: the embedded deformation of R. W. Sumner, J. Schmid and M. Pauly, "Embedded
/// deformation for shape manipulation", SIGGRAPH 2007, with rotations instead of affine maps.
/// Nothing allocates after construction.
class DeformationGraph {
 public:
  static constexpr int kInfluences = 3;  // graph nodes per mesh node
  static constexpr int kNeighbours = 3;  // neighbours per graph node

  struct Influence {
    std::array<int, kInfluences> nodes;  // graph nodes
    std::array<double, kInfluences> weights;
  };

  /// Nodes by farthest-point sampling, starting at the clamp. Throws std::invalid_argument unless
  /// there are more than kInfluences, and no more than mesh nodes.
  DeformationGraph(const elasticity::Body& body, int nodes);

  int size() const noexcept { return static_cast<int>(turn_.size()); }
  const Influence& influence(int mesh_node) const noexcept { return influences_[mesh_node]; }
  const std::vector<std::pair<int, int>>& edges() const noexcept { return edges_; }

  /// Vector from a graph node to a node of the mesh or of the graph, rotated with the first, m.
  Eigen::Vector3d arm_to_mesh(int node, int mesh_node) const noexcept;
  Eigen::Vector3d arm_to_node(int node, int other) const noexcept;
  Eigen::Vector3d place(int node) const noexcept { return at_rest_.col(node) + shift_.col(node); }

  void reset() noexcept;
  /// Rotates a node by a rotation vector in O, rad, and translates it, m.
  void move(int node, const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) noexcept;
  /// Mesh deformed by the graph, 3 x n, m.
  void draw(Eigen::Matrix3Xd& shape) const noexcept;

 private:
  Eigen::Matrix3Xd mesh_, at_rest_, shift_;  // m
  std::vector<Eigen::Matrix3d> turn_;
  std::vector<Influence> influences_;  // by mesh node
  std::vector<std::pair<int, int>> edges_;
};

}  // namespace palpate::baselines
