#pragma once

#include "core/contact/surface_match.hpp"

namespace palpate::contact {

/// Where a surface has edges at rest, that is, where two of its faces meet at an angle. Beside an
/// edge a seen point may be of either side, and noise decides of which it is taken to be (Turk and
/// Levoy 1994 leave such pairs out). Nothing allocates after construction.
class SurfaceEdges {
 public:
  /// `rest`: 3 x n, m.
  SurfaceEdges(const Eigen::Matrix3Xd& rest, const mesh::Surface& surface);

  int count() const noexcept { return static_cast<int>(from_.cols()); }
  /// Whether an edge is nearer than `distance`, m at rest, to where a point of the surface is then.
  bool is_near(const SurfaceMatch& match, double distance) const noexcept;

 private:
  Eigen::Matrix3Xd rest_;
  Eigen::Matrix3Xd from_, along_;  // of each edge between two corners
  Eigen::ArrayXd squared_;         // its length
};

}  // namespace palpate::contact
