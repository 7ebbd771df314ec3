#include "tools/mesh/full_volume.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "core/mesh/surface.hpp"

namespace palpate::mesh_tool {
namespace {

using Eigen::Vector3d;

/// The closest point of a triangle to p (Ericson 2005, 5.1.5).
Vector3d nearest_on(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

/// Triangles in a grid of cells, to look up those near a point.
class Lookup {
 public:
  Lookup(const mesh::TriangleSurface& surface, double cell) : surface_(surface), cell_(cell) {
    for (int t = 0; t < surface.triangle_count(); ++t) {
      Eigen::AlignedBox3d box;
      for (const int n : surface.triangles.col(t)) box.extend(Vector3d(surface.points.col(n)));
      visit(box, [&](const Key& key) { cells_[key].push_back(t); });
    }
  }

  /// The closest point within `reach` of p; false if there is none.
  bool find(const Vector3d& p, double reach, Vector3d& nearest) const {
    const Vector3d around = Vector3d::Constant(reach);
    double best = reach;
    bool found = false;
    visit(Eigen::AlignedBox3d(p - around, p + around), [&](const Key& key) {
      const auto members = cells_.find(key);
      if (members == cells_.end()) return;
      for (const int t : members->second) {
        const Vector3d q = nearest_on(surface_.points.col(surface_.triangles(0, t)),
                                      surface_.points.col(surface_.triangles(1, t)),
                                      surface_.points.col(surface_.triangles(2, t)), p);
        if (!((q - p).norm() < best)) continue;
        best = (q - p).norm();
        nearest = q;
        found = true;
      }
    });
    return found;
  }

 private:
  using Key = std::array<long, 3>;
  template <typename Visit>
  void visit(const Eigen::AlignedBox3d& box, Visit&& visit_cell) const {
    Key low{}, high{};
    for (int i = 0; i < 3; ++i) {
      low[i] = static_cast<long>(std::floor(box.min()[i] / cell_));
      high[i] = static_cast<long>(std::floor(box.max()[i] / cell_));
    }
    for (long x = low[0]; x <= high[0]; ++x)
      for (long y = low[1]; y <= high[1]; ++y)
        for (long z = low[2]; z <= high[2]; ++z) visit_cell({x, y, z});
  }

  const mesh::TriangleSurface& surface_;
  double cell_;
  std::map<Key, std::vector<int>> cells_;
};

}  // namespace

int follow_surface(const mesh::TriangleSurface& surface, mesh::MeshWithGroups& mesh) {
  // Below this it is rounding; above, another part of the surface, and too much for
  // keep_curved_volume.
  constexpr double kLeast = 1e-5, kMost = 0.15;  // relative to an edge's length
  const mesh::Surface outside =
      mesh::extract_surface(make_element_mesh(mesh.mesh, mesh::ElementOrder::kLinear));
  double longest = 0;
  for (int t = 0; t < outside.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      longest = std::max(longest, (mesh.mesh.nodes.col(outside.triangles(i, t)) -
                                   mesh.mesh.nodes.col(outside.triangles((i + 1) % 3, t)))
                                      .norm());
    }
  }
  if (!(longest > 0)) return 0;
  const Lookup lookup(surface, longest);
  int count = 0;
  for (int t = 0; t < outside.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const int a = outside.triangles(i, t), b = outside.triangles((i + 1) % 3, t);
      if (a > b) continue;  // the neighbour's turn
      const Vector3d from = mesh.mesh.nodes.col(a), to = mesh.mesh.nodes.col(b);
      const double length = (to - from).norm();
      const Vector3d middle = 0.5 * (from + to);
      Vector3d nearest;
      if (!lookup.find(middle, kMost * length, nearest)) continue;
      if ((nearest - middle).norm() < kLeast * length) continue;
      mesh.middles[{a, b}] = nearest;
      ++count;
    }
  }
  return count;
}

}  // namespace palpate::mesh_tool
