#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/mesh/triangle_surface.hpp"

namespace palpate::collision {

/// Signed distance of a closed triangle mesh, sampled on a regular grid and interpolated
/// trilinearly: the error is of second order in the cell on smooth parts and of first order at
/// edges, which are rounded by about a cell. The sign is that of the angle-weighted pseudonormal at
/// the nearest point (Baerentzen and Aanaes 2005).
class DistanceGrid {
 public:
  /// `surface`: closed and oriented outward, m; `cell`: m, side of a cell. Throws
  /// std::invalid_argument, naming the fault, if the surface is not closed, not consistently
  /// oriented or oriented inward, has a point that is not finite, or needs more than kMostCells.
  DistanceGrid(const mesh::TriangleSurface& surface, double cell);

  static constexpr double kMostCells = 8e6;

  /// Signed distance, m, of `p` in the frame of the surface, negative inside. Outside the grid,
  /// which extends a few cells beyond the surface: a lower bound.
  double distance(const Eigen::Vector3d& p) const noexcept;
  /// Unit gradient of the distance at `p`, or nearest to it in the grid.
  Eigen::Vector3d normal(const Eigen::Vector3d& p) const noexcept;
  double cell() const noexcept { return cell_; }  // m
  const Eigen::AlignedBox3d& bounds() const noexcept { return bounds_; }

 private:
  struct Cell {
    int corner[3];             // of the cell's lower corner
    Eigen::Vector3d fraction;  // of the point within the cell, 0 to 1
  };
  Cell cell_at(const Eigen::Vector3d& p) const noexcept;
  double value(const Cell& cell, int x, int y, int z) const noexcept {
    return values_[cell.corner[0] + x +
                   static_cast<std::size_t>(size_[0]) *
                       (cell.corner[1] + y +
                        static_cast<std::size_t>(size_[1]) * (cell.corner[2] + z))];
  }

  double cell_;
  Eigen::AlignedBox3d bounds_;
  int size_[3];  // nodes along each axis
  std::vector<float> values_;
};

}  // namespace palpate::collision
