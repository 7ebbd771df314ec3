#pragma once

#include <array>
#include <vector>

#include "core/mesh/surface.hpp"

namespace palpate::contact {

/// The point of a deformed surface nearest to one that was seen.
struct SurfaceMatch {
  int count = 0;  // of nodes: 3 or 6; 0: the surface is empty
  std::array<int, 6> nodes{};
  std::array<double, 6> weights{};                     // of the nodes, sum 1
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // of length 1, outward
  double distance = 0;                                 // m, unsigned
};

/// Finds nearest points on the surface of a deformed mesh, curved where its elements are: a chord
/// of a bent bar lies half a millimetre beside it. Bounding spheres of the faces leave a few faces
/// to be looked at closely. Nothing allocates after construction.
class SurfaceMatcher {
 public:
  /// `steps` along a curved face after the nearest place of its flat quarters: what one leaves is
  /// of second order in distance, many find the very foot of the perpendicular.
  explicit SurfaceMatcher(const mesh::Surface& surface, int steps = 1);

  /// The surface has this shape from now on: 3 x n, m, which must stay as long as it is asked for.
  void take(const Eigen::Matrix3Xd& positions) noexcept;
  SurfaceMatch find(const Eigen::Vector3d& p) const noexcept;

 private:
  struct Face {
    int count = 0;
    std::array<int, 6> nodes{};
  };
  struct Place {
    int face = -1;
    Eigen::Vector3d areal = Eigen::Vector3d::Zero();
    double squared = 0;  // m^2, of the distance
  };
  void look_closely(int face, const Eigen::Vector3d& p, Place& best) const noexcept;
  SurfaceMatch on(const Place& place, const Eigen::Vector3d& p) const noexcept;

  int steps_;
  std::vector<Face> faces_;
  const Eigen::Matrix3Xd* positions_ = nullptr;
  Eigen::Array3Xd centers_;
  Eigen::ArrayXd radii_;
  mutable Eigen::ArrayXd squared_;  // room for find(), from the point to the centres
};

}  // namespace palpate::contact
