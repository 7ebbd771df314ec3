#pragma once

#include "core/contact/surface_match.hpp"
#include "core/estimation/estimator.hpp"

namespace palpate::published_sensing {

/// A point that was seen, and the place of the surface that was nearest to it.
struct CloudMatch {
  contact::SurfaceMatch place;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m, in O

  /// Of the place's nodes, positions or velocities.
  Eigen::Vector3d of(const Eigen::Matrix3Xd& nodal) const noexcept {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < place.count; ++i) sum += place.weights[i] * nodal.col(place.nodes[i]);
    return sum;
  }
};

/// The correspondence step of iterated closest points, spread over ticks: each point of a cloud
/// gets the nearest place of the surface as that is in the tick of its turn. A cloud's matches are
/// given out when all are there. Nothing allocates after construction.
class CloudMatches {
 public:
  /// `reach`: m, points farther off the surface are of something else.
  CloudMatches(const mesh::Surface& surface, double reach, int points_per_tick);

  void reset() noexcept;
  /// A new cloud; what was left of the one before is dropped.
  void begin(const estimation::ObservationInput::Points& points) noexcept;
  bool is_busy() const noexcept { return next_ < points_.cols(); }
  /// The next points. True when these were the last: from then on matches() is of this cloud.
  bool advance(const Eigen::Matrix3Xd& positions) noexcept;

  int count() const noexcept { return count_; }
  const CloudMatch& operator[](int i) const noexcept { return matches_[i]; }
  /// Root mean square distance of points from their places when they were found, m.
  double distance() const noexcept { return distance_; }

 private:
  using Matches = std::array<CloudMatch, estimation::ObservationInput::kMostPoints>;
  contact::SurfaceMatcher matcher_;
  double reach_;
  int points_per_tick_;
  estimation::ObservationInput::Points points_;
  Eigen::Index next_ = 0;
  Matches matches_, found_;
  int count_ = 0, found_count_ = 0;
  double distance_ = 0, squared_ = 0;
};

}  // namespace palpate::published_sensing
