#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <vector>

namespace palpate::collision {

/// Binary tree of axis-aligned boxes over items that may move: built once by median splits, then
/// refitted, which keeps its shape (van den Bergen 1997). Nothing allocates after construction.
class BoxTree {
 public:
  /// `boxes`: one per item.
  explicit BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes);

  /// Adapts the tree to items that have moved; `box(item)` returns the present box.
  template <class Box>
  void refit(const Box& box) noexcept {
    refit_some(box, 0, size());
  }

  /// A part of that: the boxes from `begin`, at most `count` of size(). The tree is adapted once
  /// parts from 0 to size() have been, one after the other.
  template <class Box>
  void refit_some(const Box& box, int begin, int count) noexcept {
    // children follow their parent
    const int last = size() - 1 - begin, end = std::max(-1, last - count);
    for (int k = last; k > end; --k) {
      Node& node = nodes_[k];
      if (node.item >= 0) {
        node.box = box(node.item);
      } else {
        node.box = nodes_[k + 1].box.merged(nodes_[node.second].box);
      }
    }
  }
  /// Number of boxes, those of the leaves included.
  int size() const noexcept { return static_cast<int>(nodes_.size()); }

  /// Box of all items at the last refit; empty without items.
  Eigen::AlignedBox3d bounds() const noexcept {
    return nodes_.empty() ? Eigen::AlignedBox3d() : nodes_.front().box;
  }

  /// Calls visit(item) for the items of leaves all of whose enclosing boxes are accepted by
  /// accept(box), in the fixed order of the tree.
  template <class Accept, class Visit>
  void visit(const Accept& accept, const Visit& visit) const noexcept {
    std::array<int, kDeepest> waiting;
    int count = 0;
    if (!nodes_.empty()) waiting[count++] = 0;
    while (count > 0) {
      const int k = waiting[--count];
      const Node& node = nodes_[k];
      if (!accept(node.box)) continue;
      if (node.item >= 0) {
        visit(node.item);
      } else {
        waiting[count++] = node.second;
        waiting[count++] = k + 1;
      }
    }
  }

 private:
  static constexpr int kDeepest = 64;  // median splits halve the number of items
  struct Node {
    Eigen::AlignedBox3d box;
    int item = -1;   // of a leaf
    int second = 0;  // second child; the first one follows its parent
  };

  void build(const std::vector<Eigen::AlignedBox3d>& boxes, int* begin, int* end);

  std::vector<Node> nodes_;
};

}  // namespace palpate::collision
