#pragma once

#include "core/contact/surface_match.hpp"
#include "core/estimation/estimator.hpp"

namespace palpate::baselines {

/// Observed point and the surface point nearest to it.
struct CloudMatch {
  contact::SurfaceMatch place;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m, in O

  /// Value of a nodal field (positions or velocities) at the surface point.
  Eigen::Vector3d of(const Eigen::Matrix3Xd& nodal) const noexcept {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < place.count; ++i) sum += place.weights[i] * nodal.col(place.nodes[i]);
    return sum;
  }
};

/// Correspondence step of iterative closest points, spread over ticks: each point of a cloud is
/// assigned the surface point that is nearest in the tick of its processing. The matches of a cloud
/// are published when all are available. Nothing allocates after construction.
class CloudMatches {
 public:
  /// `reach`: m, points farther from the surface belong to other objects.
  CloudMatches(const mesh::Surface& surface, double reach, int points_per_tick);

  void reset() noexcept;
  /// Starts a new cloud; the remainder of the previous one is dropped.
  void begin(const estimation::ObservationInput::Points& points) noexcept;
  bool is_busy() const noexcept { return next_ < points_.cols(); }
  /// Processes the next points. Returns true when they were the last; matches() then refers to this
  /// cloud.
  bool advance(const Eigen::Matrix3Xd& positions) noexcept;

  int count() const noexcept { return count_; }
  const CloudMatch& operator[](int i) const noexcept { return matches_[i]; }
  /// Root mean square distance between points and their matches at the time of matching, m.
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

}  // namespace palpate::baselines
