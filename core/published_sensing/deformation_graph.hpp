#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::published_sensing {

/// A few nodes spread over a mesh, each with a turn and a shift, that blend over the mesh between
/// them: the embedded deformation of R. W. Sumner, J. Schmid and M. Pauly, "Embedded deformation
/// for shape manipulation", SIGGRAPH 2007, with rotations in place of affine maps. Nothing
/// allocates after construction.
class DeformationGraph {
 public:
  static constexpr int kInfluences = 3;  // of a node of the mesh
  static constexpr int kNeighbours = 3;  // of a node of the graph

  struct Influence {
    std::array<int, kInfluences> nodes;  // of the graph
    std::array<double, kInfluences> weights;
  };

  /// Nodes as far from each other as can be, the first where the object is clamped. Throws
  /// std::invalid_argument unless there are more than kInfluences, and no more than of the mesh.
  DeformationGraph(const elasticity::Body& body, int nodes);

  int size() const noexcept { return static_cast<int>(turn_.size()); }
  const Influence& influence(int mesh_node) const noexcept { return influences_[mesh_node]; }
  const std::vector<std::pair<int, int>>& edges() const noexcept { return edges_; }

  /// From a node of the graph to one of the mesh or of the graph, turned with the first, m.
  Eigen::Vector3d arm_to_mesh(int node, int mesh_node) const noexcept;
  Eigen::Vector3d arm_to_node(int node, int other) const noexcept;
  Eigen::Vector3d place(int node) const noexcept { return at_rest_.col(node) + shift_.col(node); }

  void reset() noexcept;
  /// Turns a node further by a rotation vector in O, rad, and shifts it, m.
  void move(int node, const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) noexcept;
  /// The mesh under the graph, 3 x n, m.
  void draw(Eigen::Matrix3Xd& shape) const noexcept;

 private:
  Eigen::Matrix3Xd mesh_, at_rest_, shift_;  // m
  std::vector<Eigen::Matrix3d> turn_;
  std::vector<Influence> influences_;  // by node of the mesh
  std::vector<std::pair<int, int>> edges_;
};

}  // namespace palpate::published_sensing
