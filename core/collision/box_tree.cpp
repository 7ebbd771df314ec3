#include "core/collision/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace palpate::collision {

BoxTree::BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes) {
  if (boxes.empty()) return;
  std::vector<int> items(boxes.size());
  std::iota(items.begin(), items.end(), 0);
  nodes_.reserve(2 * boxes.size() - 1);
  build(boxes, items.data(), items.data() + items.size());
}

void BoxTree::build(const std::vector<Eigen::AlignedBox3d>& boxes, int* begin, int* end) {
  const std::size_t at = nodes_.size();
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  for (const int* item = begin; item != end; ++item) box.extend(boxes[*item]);
  nodes_[at].box = box;
  if (end - begin == 1) {
    nodes_[at].item = *begin;
    return;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  int* middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end, [&](int a, int b) {
    const double ca = boxes[a].center()[axis], cb = boxes[b].center()[axis];
    return ca != cb ? ca < cb : a < b;
  });
  build(boxes, begin, middle);
  nodes_[at].second = static_cast<int>(nodes_.size());
  build(boxes, middle, end);
}

}  // namespace palpate::collision
