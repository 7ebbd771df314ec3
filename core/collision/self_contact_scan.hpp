#pragma once

#include <vector>

#include "core/collision/box_tree.hpp"
#include "core/mesh/surface.hpp"

namespace palpate::collision {

/// Where a deformable object, whose parts pass through one another in the model, overlaps itself:
/// nodes of the surface inside an element that is no neighbour of theirs. Each look() refits part
/// of a tree of the elements' boxes or examines the next nodes, so that its cost does not grow with
/// the mesh. Elements count with straight edges; a node is inside if it is deeper below the surface
/// than kDepth of the element's height, about 1 mm in an element of 50 mm. Overlaps without such a
/// node, as of two edges, are found once they are deeper. Nothing allocates after construction.
class SelfContactScan {
 public:
  static constexpr int kLook = 4, kRefit = 16;  // nodes, and boxes of the tree, of each look()
  static constexpr double kDepth = 0.02;

  /// Nodes that are inside another part at rest, where a mesh overlaps itself, are left out.
  SelfContactScan(const mesh::ElementMesh& mesh, const mesh::Surface& surface);

  /// At positions x (3 x n), m.
  void look(const Eigen::Matrix3Xd& x) noexcept;

  /// A node that was inside in the last complete turn or has been in this one; -1 for none.
  int node() const noexcept { return now_ >= 0 ? now_ : last_; }
  /// Forgets what was seen.
  void reset() noexcept;

 private:
  Eigen::AlignedBox3d box_of(int element) const noexcept;
  bool is_inside(const Eigen::Vector3d& point, int element) const noexcept;
  bool touches(int index) const noexcept;

  Eigen::MatrixXi elements_;             // nodes of each, by column; corners first
  Eigen::Matrix4Xd least_;               // barycentric coordinates of points inside, by column
  std::vector<int> nodes_;               // of the surface
  std::vector<int> begin_, neighbours_;  // of nodes_[i]: its elements' neighbours, sorted
  Eigen::Matrix3Xd x_;                   // during a turn
  BoxTree tree_;
  int refitted_ = 0;  // boxes of the tree in this turn; all: nodes are examined
  int next_ = 0;      // node
  int last_ = -1, now_ = -1;
};

}  // namespace palpate::collision
