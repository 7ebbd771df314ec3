#include "core/collision/self_contact_scan.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <set>

namespace palpate::collision {
namespace {

constexpr int kCorners = 4;

std::vector<Eigen::AlignedBox3d> boxes_of(const mesh::ElementMesh& mesh) {
  std::vector<Eigen::AlignedBox3d> boxes(static_cast<std::size_t>(mesh.element_count()));
  for (int e = 0; e < mesh.element_count(); ++e)
    for (const int node : mesh.elements.col(e)) boxes[e].extend(mesh.nodes.col(node));
  return boxes;
}

/// By corner of each element: kDepth if the opposite face is on the surface, else 0 less rounding,
/// so that a point on a face between two elements is inside.
Eigen::Matrix4Xd least_coordinates(const mesh::ElementMesh& mesh, const mesh::Surface& surface) {
  constexpr double kRounding = 1e-9;
  const auto sorted = [](std::array<int, 3> face) {
    std::sort(face.begin(), face.end());
    return face;
  };
  std::set<std::array<int, 3>> faces;
  for (int t = 0; t < surface.triangles.cols(); ++t)
    faces.insert(
        sorted({surface.triangles(0, t), surface.triangles(1, t), surface.triangles(2, t)}));
  Eigen::Matrix4Xd least(kCorners, mesh.element_count());
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int i = 0; i < kCorners; ++i) {
      std::array<int, 3> face{};
      for (int k = 0; k < 3; ++k) face[k] = mesh.elements((i + 1 + k) % kCorners, e);
      least(i, e) = faces.count(sorted(face)) > 0 ? SelfContactScan::kDepth : -kRounding;
    }
  }
  return least;
}

}  // namespace

SelfContactScan::SelfContactScan(const mesh::ElementMesh& mesh, const mesh::Surface& surface)
    : elements_(mesh.elements),
      least_(least_coordinates(mesh, surface)),
      x_(mesh.nodes),
      tree_(boxes_of(mesh)) {
  std::vector<std::vector<int>> of_node(static_cast<std::size_t>(mesh.node_count()));
  for (int e = 0; e < mesh.element_count(); ++e)
    for (const int node : mesh.elements.col(e)) of_node[node].push_back(e);
  for (const int node : surface.nodes) {
    std::vector<int> near;
    for (const int e : of_node[node])
      for (const int other : elements_.col(e))
        near.insert(near.end(), of_node[other].begin(), of_node[other].end());
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    nodes_.push_back(node);
    begin_.push_back(static_cast<int>(neighbours_.size()));
    neighbours_.insert(neighbours_.end(), near.begin(), near.end());
  }
  begin_.push_back(static_cast<int>(neighbours_.size()));
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (touches(static_cast<int>(i))) nodes_[i] = -1;
}

Eigen::AlignedBox3d SelfContactScan::box_of(int element) const noexcept {
  Eigen::AlignedBox3d box;
  for (const int node : elements_.col(element).head<kCorners>()) box.extend(x_.col(node));
  return box;
}

bool SelfContactScan::is_inside(const Eigen::Vector3d& point, int element) const noexcept {
  const auto nodes = elements_.col(element);
  Eigen::Matrix3d edges;
  for (int i = 0; i < 3; ++i) edges.col(i) = x_.col(nodes[i + 1]) - x_.col(nodes[0]);
  Eigen::Vector4d share;
  share.tail<3>() = edges.inverse() * (point - x_.col(nodes[0]));
  share[0] = 1 - share.tail<3>().sum();
  return (share.array() > least_.col(element).array()).all();  // false if it is not a number
}

bool SelfContactScan::touches(int index) const noexcept {
  const Eigen::Vector3d point = x_.col(nodes_[index]);
  const auto begin = neighbours_.begin() + begin_[index],
             end = neighbours_.begin() + begin_[index + 1];
  bool any = false;
  tree_.visit([&](const Eigen::AlignedBox3d& box) { return !any && box.contains(point); },
              [&](int element) {
                any = !std::binary_search(begin, end, element) && is_inside(point, element);
              });
  return any;
}

void SelfContactScan::look(const Eigen::Matrix3Xd& x) noexcept {
  if (x.cols() != x_.cols() || nodes_.empty()) return;
  if (refitted_ < tree_.size()) {
    if (refitted_ == 0) x_ = x;
    tree_.refit_some([this](int element) { return box_of(element); }, refitted_, kRefit);
    refitted_ = std::min(refitted_ + kRefit, tree_.size());
    return;
  }
  const int count = static_cast<int>(nodes_.size());
  for (int k = 0; k < kLook && next_ < count; ++k, ++next_)
    if (nodes_[next_] >= 0 && touches(next_)) now_ = nodes_[next_];
  if (next_ < count) return;
  last_ = now_;
  now_ = -1;
  next_ = refitted_ = 0;
}

void SelfContactScan::reset() noexcept {
  refitted_ = next_ = 0;
  last_ = now_ = -1;
}

}  // namespace palpate::collision
