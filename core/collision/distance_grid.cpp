#include "core/collision/distance_grid.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "core/collision/box_tree.hpp"
#include "core/mesh/closest_point.hpp"
#include "core/mesh/surface_topology.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

constexpr int kBorderCells = 3;  // around the surface

void require(bool condition, const std::string& message) {
  if (!condition) throw std::invalid_argument("distance grid: " + message);
}

/// Checks what signed distances rest on.
const mesh::TriangleSurface& checked(const mesh::TriangleSurface& surface) {
  require(surface.triangle_count() > 0, "the surface has no triangles");
  require(surface.points.allFinite(), "a point of the surface is not finite");
  require(surface.triangles.minCoeff() >= 0 && surface.triangles.maxCoeff() < surface.point_count(),
          "a triangle names a point out of range");
  const mesh::SurfaceTopology topology(surface);
  require(topology.holes().empty(), "the surface is not closed");
  require(topology.crowded_edges().empty(), "an edge belongs to more than two triangles");
  const mesh::SurfaceSides sides = topology.sides();
  require(sides.one_sided.empty() &&
              std::find(sides.turned.begin(), sides.turned.end(), true) == sides.turned.end(),
          "the triangles are not consistently oriented");
  require(mesh::enclosed_volume(surface) > 0, "the surface is oriented inward");
  return surface;
}

/// Nearest points of a surface and the side on which a point lies.
class SignedSearch {
 public:
  explicit SignedSearch(const mesh::TriangleSurface& surface)
      : surface_(surface), tree_(boxes(surface)), at_point_(surface.point_count()) {
    for (Vector3d& normal : at_point_) normal.setZero();
    for (int t = 0; t < surface.triangle_count(); ++t) {
      const Vector3d normal = across(t).normalized();
      for (int i = 0; i < 3; ++i) {
        const Vector3d to_next = (corner(t, (i + 1) % 3) - corner(t, i)).normalized();
        const Vector3d to_last = (corner(t, (i + 2) % 3) - corner(t, i)).normalized();
        const double angle = std::acos(std::clamp(to_next.dot(to_last), -1.0, 1.0));
        at_point_[surface.triangles(i, t)] += angle * normal;
        auto& edge = at_edge_.try_emplace(edge_of(t, i), Vector3d::Zero()).first->second;
        edge += normal;
      }
    }
  }

  /// Signed distance of `p`, of which an upper bound is known.
  double find(const Vector3d& p, double bound) const {
    mesh::SurfacePoint nearest;
    nearest.distance = bound;
    tree_.visit(
        [&](const Eigen::AlignedBox3d& box) {
          return box.squaredExteriorDistance(p) <= nearest.distance * nearest.distance;
        },
        [&](int t) {
          const mesh::SurfacePoint point =
              mesh::closest_point_on_triangle(p, corner(t, 0), corner(t, 1), corner(t, 2));
          if (nearest.triangle >= 0 && point.distance >= nearest.distance) return;
          nearest = point;
          nearest.triangle = t;
        });
    const double side = pseudonormal(nearest).dot(p - nearest.position);
    return std::copysign(nearest.distance, side);
  }

 private:
  static std::vector<Eigen::AlignedBox3d> boxes(const mesh::TriangleSurface& surface) {
    std::vector<Eigen::AlignedBox3d> all(surface.triangle_count());
    for (int t = 0; t < surface.triangle_count(); ++t) {
      for (int i = 0; i < 3; ++i) {
        all[t].extend(Vector3d(surface.points.col(surface.triangles(i, t))));
      }
    }
    return all;
  }
  Vector3d corner(int t, int i) const { return surface_.points.col(surface_.triangles(i, t)); }
  Vector3d across(int t) const {
    return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
  }
  std::pair<int, int> edge_of(int t, int i) const {
    const int a = surface_.triangles(i, t), b = surface_.triangles((i + 1) % 3, t);
    return std::minmax(a, b);
  }

  /// Of the face, edge or corner that contains the point.
  Vector3d pseudonormal(const mesh::SurfacePoint& point) const {
    constexpr double kOnBorder = 1e-9;
    int inside = 0, largest = 0, smallest = 0;
    for (int i = 0; i < 3; ++i) {
      inside += point.weights[i] > kOnBorder;
      if (point.weights[i] > point.weights[largest]) largest = i;
      if (point.weights[i] < point.weights[smallest]) smallest = i;
    }
    if (inside == 1) return at_point_[surface_.triangles(largest, point.triangle)];
    if (inside == 2) return at_edge_.at(edge_of(point.triangle, (smallest + 1) % 3));
    return across(point.triangle);
  }

  const mesh::TriangleSurface& surface_;
  BoxTree tree_;
  std::vector<Vector3d> at_point_;
  std::map<std::pair<int, int>, Vector3d> at_edge_;
};

}  // namespace

DistanceGrid::DistanceGrid(const mesh::TriangleSurface& surface, double cell) : cell_(cell) {
  require(cell > 0 && std::isfinite(cell), "the cell must be larger than 0");
  const SignedSearch search(checked(surface));
  const Vector3d border = Vector3d::Constant(kBorderCells * cell);
  const Vector3d lower = surface.points.rowwise().minCoeff() - border;
  const Vector3d extent = surface.points.rowwise().maxCoeff() + border - lower;
  double total = 1;
  for (int axis = 0; axis < 3; ++axis) total *= std::ceil(extent[axis] / cell) + 1;
  require(total <= kMostCells, "the cell of " + std::to_string(cell) + " m is too small");
  for (int axis = 0; axis < 3; ++axis) {
    size_[axis] = static_cast<int>(std::ceil(extent[axis] / cell)) + 1;
  }
  bounds_ = {lower, lower + cell * Vector3d(size_[0] - 1, size_[1] - 1, size_[2] - 1)};
  values_.reserve(static_cast<std::size_t>(total));
  for (int z = 0; z < size_[2]; ++z) {
    for (int y = 0; y < size_[1]; ++y) {
      double bound = std::numeric_limits<double>::max();
      for (int x = 0; x < size_[0]; ++x) {
        const double found = search.find(lower + cell * Vector3d(x, y, z), bound);
        values_.push_back(static_cast<float>(found));
        bound = (std::abs(found) + cell) * (1 + 1e-9);
      }
    }
  }
}

DistanceGrid::Cell DistanceGrid::cell_at(const Vector3d& p) const noexcept {
  Cell cell;
  for (int axis = 0; axis < 3; ++axis) {
    const double place =
        std::clamp((p[axis] - bounds_.min()[axis]) / cell_, 0.0, size_[axis] - 1.0);
    cell.corner[axis] = std::min(static_cast<int>(place), size_[axis] - 2);
    cell.fraction[axis] = place - cell.corner[axis];
  }
  return cell;
}

double DistanceGrid::distance(const Vector3d& p) const noexcept {
  const Cell cell = cell_at(p);
  const Vector3d &f = cell.fraction, g = Vector3d::Ones() - f;
  const auto along_x = [&](int y, int z) {
    return g[0] * value(cell, 0, y, z) + f[0] * value(cell, 1, y, z);
  };
  const double inside = g[2] * (g[1] * along_x(0, 0) + f[1] * along_x(1, 0)) +
                        f[2] * (g[1] * along_x(0, 1) + f[1] * along_x(1, 1));
  const double outside = bounds_.exteriorDistance(p);
  return outside > 0 ? std::max(inside, outside) : inside;
}

Vector3d DistanceGrid::normal(const Vector3d& p) const noexcept {
  const Cell cell = cell_at(p);
  Vector3d gradient = Vector3d::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const int at[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
    const double v = value(cell, at[0], at[1], at[2]);
    for (int axis = 0; axis < 3; ++axis) {
      double weight = at[axis] != 0 ? 1 : -1;
      for (int other = 0; other < 3; ++other) {
        if (other == axis) continue;
        weight *= at[other] != 0 ? cell.fraction[other] : 1 - cell.fraction[other];
      }
      gradient[axis] += weight * v;
    }
  }
  const double size = gradient.norm();
  return size > 0 ? Vector3d(gradient / size) : Vector3d(Vector3d::UnitZ());
}

}  // namespace palpate::collision
