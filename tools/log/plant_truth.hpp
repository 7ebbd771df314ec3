#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>
#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::log {

/// A mesh assembled from the chunks of SHAPE_MESH or TRUTH_MESH.
struct MeshMessage {
  std::int64_t hash = 0;
  int element_kind = 0;
  Eigen::Matrix3Xd nodes;      // 3 x n rest positions in O, m
  Eigen::MatrixXi elements;    // nodes per element x m: 4 or 10 (VTK's order), or 27
  Eigen::Matrix3Xi triangles;  // surface, outward
  std::vector<int> constrained;

  double longest_side() const;  // of the bounding box at rest, m
};

/// From a whole mesh (bus::MeshAssembler).
MeshMessage mesh_of(const shape_mesh_t& whole);

/// From the chunks of the first complete mesh. Throws std::runtime_error if there is none.
MeshMessage assemble(const std::vector<shape_mesh_t>& chunks);

/// Positions of a whole shape, 3 x n, m.
Eigen::Matrix3Xd positions(const shape_t& shape);

/// Points of B, 3 x n, in A.
Eigen::Matrix3Xd transformed(const math::Pose& X_AB, const Eigen::Matrix3Xd& points);

/// Material points of the plant as weighted sums of its nodes. The elements are linear tetrahedra
/// or 27-node hexahedra whose rest shape is a box; the order of the nodes in an element is
/// arbitrary, since each node's rest position determines its shape function.
class PlantPoints {
 public:
  /// rest_points: 3 x n in O, m. A point outside uses the nearest element. Throws
  /// std::runtime_error if the mesh has other elements.
  PlantPoints(const MeshMessage& plant, const Eigen::Matrix3Xd& rest_points);

  /// Positions of the points for the plant's nodes, 3 x n.
  Eigen::Matrix3Xd at(const Eigen::Matrix3Xd& plant_positions) const;

 private:
  void place_in_boxes(const MeshMessage& plant, const Eigen::Matrix3Xd& rest_points);
  void place_in_tetrahedra(const MeshMessage& plant, const Eigen::Matrix3Xd& rest_points);

  Eigen::MatrixXi nodes_;    // nodes per element x points
  Eigen::MatrixXd weights_;  // alike
};

/// Node positions of the plant over time, linearly interpolated between two messages.
class PlantMotion {
 public:
  explicit PlantMotion(const std::vector<shape_t>& truths);
  /// False if `utime` lies outside the recording.
  bool at(std::int64_t utime, Eigen::Matrix3Xd& plant_positions) const;
  bool empty() const { return truths_->empty(); }

 private:
  const std::vector<shape_t>* truths_;
};

}  // namespace palpate::log
