#pragma once

#include <array>
#include <vector>

#include "core/mesh/surface.hpp"

namespace palpate::contact {

/// Point of a deformed surface nearest to an observed point.
struct SurfaceMatch {
  int count = 0;  // number of nodes: 3 or 6; 0: the surface is empty
  std::array<int, 6> nodes{};
  std::array<double, 6> weights{};                     // weights of the nodes, sum 1
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // unit outward normal
  double distance = 0;                                 // m, unsigned
};

/// Finds nearest points on the surface of a deformed mesh, curved where its elements are: a chord
/// of a bent bar deviates from it by half a millimetre. Bounding spheres restrict the exact search
/// to a few faces. Nothing allocates after construction.
class SurfaceMatcher {
 public:
  /// `steps`: iterations on the curved face, starting at the nearest point of its flat quarters.
  /// The error after one step is of second order in the distance; more steps converge to the foot
  /// of the perpendicular.
  explicit SurfaceMatcher(const mesh::Surface& surface, int steps = 1);

  /// Sets the shape of the surface: 3 x n, m, which must remain valid while queries are made.
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
    double squared = 0;  // m^2, squared distance
  };
  void look_closely(int face, const Eigen::Vector3d& p, Place& best) const noexcept;
  SurfaceMatch on(const Place& place, const Eigen::Vector3d& p) const noexcept;

  int steps_;
  std::vector<Face> faces_;
  const Eigen::Matrix3Xd* positions_ = nullptr;
  Eigen::Array3Xd centers_;
  Eigen::ArrayXd radii_;
  /// Workspace of find(): squared distances from the point to the centres.
  mutable Eigen::ArrayXd squared_;
};

/// Edges of a surface at rest, where two of its faces meet at an angle. Near an edge an observed
/// point may belong to either face, and noise decides to which it is assigned (Turk and Levoy 1994
/// discard such pairs). Nothing allocates after construction.
class SurfaceEdges {
 public:
  /// `rest`: rest positions, 3 x n, m.
  SurfaceEdges(const Eigen::Matrix3Xd& rest, const mesh::Surface& surface);

  int count() const noexcept { return static_cast<int>(from_.cols()); }
  /// True if an edge is nearer than `distance`, m at rest, to the matched surface point.
  bool is_near(const SurfaceMatch& match, double distance) const noexcept;

 private:
  Eigen::Matrix3Xd rest_;
  Eigen::Matrix3Xd from_, along_;  // start and direction of each edge between two corners
  Eigen::ArrayXd squared_;         // squared length of each edge
};

}  // namespace palpate::contact
