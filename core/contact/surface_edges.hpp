#pragma once

#include "core/contact/surface_match.hpp"

namespace palpate::contact {

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
