#include "core/mesh/triangle_intersections.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/mesh/near_nodes.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Triangle = std::array<Vector3d, 3>;

/// relative to the size of the two triangles: smaller lengths are rounding errors
constexpr double kRounding = 1e-9;

struct Candidate {
  Triangle x;
  Eigen::Vector3i corners;
  Vector3d normal;  // unit normal
  Eigen::AlignedBox3d box;
  double size = 0;  // longest edge
};

/// Whether a point in the triangle's plane lies inside it, by more than `margin` from its edges.
bool is_within(const Candidate& c, const Vector3d& p, double margin) {
  for (int i = 0; i < 3; ++i) {
    const Vector3d along = (c.x[(i + 1) % 3] - c.x[i]).normalized();
    if (c.normal.cross(along).dot(p - c.x[i]) <= margin) return false;
  }
  return true;
}

/// Whether a segment intersects the interior of a triangle, or touches it if `margin` < 0.
bool crosses(const Candidate& c, const Vector3d& from, const Vector3d& to, double rounding,
             double margin) {
  const double a = c.normal.dot(from - c.x[0]), b = c.normal.dot(to - c.x[0]);
  if ((a > rounding && b > rounding) || (a < -rounding && b < -rounding)) return false;
  if (std::abs(a) <= rounding && std::abs(b) <= rounding)
    return false;  // the segment lies in the plane
  const double share = std::clamp(a / (a - b), 0.0, 1.0);
  return is_within(c, from + share * (to - from), margin);
}

/// Whether coplanar triangles overlap: no edge of either separates them.
bool overlaps_in_plane(const Candidate& c, const Candidate& d, double rounding) {
  const auto parts = [rounding](const Candidate& one, const Candidate& other) {
    for (int i = 0; i < 3; ++i) {
      const Vector3d inward = one.normal.cross((one.x[(i + 1) % 3] - one.x[i]).normalized());
      double most = -INFINITY;
      for (const Vector3d& p : other.x) most = std::max(most, inward.dot(p - one.x[i]));
      if (most <= rounding) return true;
    }
    return false;
  };
  return !parts(c, d) && !parts(d, c);
}

bool intersect(const Candidate& c, const Candidate& d) {
  const double rounding = kRounding * std::max(c.size, d.size);
  std::vector<int> shared;
  for (const int n : c.corners) {
    if ((d.corners.array() == n).any()) shared.push_back(n);
  }
  const auto is_shared = [&shared](int n) {
    return std::find(shared.begin(), shared.end(), n) != shared.end();
  };
  if (shared.size() == 3) return true;  // identical triangles
  bool in_plane = true;
  for (const Vector3d& p : d.x) {
    in_plane = in_plane && std::abs(c.normal.dot(p - c.x[0])) <= rounding;
  }
  if (in_plane) return overlaps_in_plane(c, d, rounding);
  if (shared.size() == 2) return false;  // they meet in the edge only, folded or not
  // Triangles with a shared corner can intersect only in the opposite edges; touching counts for
  // triangles without shared corners.
  const double margin = shared.empty() ? -rounding : rounding;
  const auto goes_through = [&](const Candidate& one, const Candidate& other) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if (is_shared(one.corners[i]) || is_shared(one.corners[j])) continue;
      if (crosses(other, one.x[i], one.x[j], rounding, margin)) return true;
    }
    return false;
  };
  return goes_through(c, d) || goes_through(d, c);
}

}  // namespace

std::vector<std::pair<int, int>> find_intersections(const TriangleSurface& surface) {
  std::vector<Candidate> all;
  std::vector<int> index;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    Candidate c;
    c.corners = surface.triangles.col(t);
    for (int i = 0; i < 3; ++i) {
      c.x[i] = surface.points.col(c.corners[i]);
      c.box.extend(c.x[i]);
    }
    for (int i = 0; i < 3; ++i) c.size = std::max(c.size, (c.x[(i + 1) % 3] - c.x[i]).norm());
    c.normal = (c.x[1] - c.x[0]).cross(c.x[2] - c.x[0]);
    if (!(c.normal.norm() > kRounding * c.size * c.size)) continue;
    c.normal.normalize();
    all.push_back(c);
    index.push_back(t);
  }
  // sweep along the longest axis of the surface
  Eigen::AlignedBox3d whole;
  for (const Candidate& c : all) whole.extend(c.box);
  int axis = 0;
  if (!all.empty()) whole.sizes().maxCoeff(&axis);
  std::vector<int> order(all.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return all[a].box.min()[axis] < all[b].box.min()[axis]; });
  std::vector<std::pair<int, int>> found;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Candidate& c = all[order[i]];
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Candidate& d = all[order[j]];
      if (d.box.min()[axis] > c.box.max()[axis]) break;
      if (!c.box.intersects(d.box) || !intersect(c, d)) continue;
      found.emplace_back(std::minmax(index[order[i]], index[order[j]]));
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace palpate::mesh
