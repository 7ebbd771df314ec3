#include "tools/lab/baselines/sensing/cloud_matches.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::baselines {

CloudMatches::CloudMatches(const mesh::Surface& surface, double reach, int points_per_tick)
    : matcher_(surface), reach_(reach), points_per_tick_(points_per_tick) {
  if (!(reach > 0) || points_per_tick < 1)
    throw std::invalid_argument("reach and points per tick of a cloud must be positive");
}

void CloudMatches::reset() noexcept {
  points_.resize(3, 0);
  next_ = 0;
  count_ = found_count_ = 0;
  distance_ = 0;
}

void CloudMatches::begin(const estimation::ObservationInput::Points& points) noexcept {
  points_ = points;
  next_ = 0;
  found_count_ = 0;
  squared_ = 0;
}

bool CloudMatches::advance(const Eigen::Matrix3Xd& positions) noexcept {
  if (!is_busy()) return false;
  matcher_.take(positions);
  const Eigen::Index end = std::min<Eigen::Index>(next_ + points_per_tick_, points_.cols());
  for (; next_ < end; ++next_) {
    const Eigen::Vector3d p = points_.col(next_);
    if (!p.allFinite()) continue;
    const contact::SurfaceMatch place = matcher_.find(p);
    if (place.count == 0 || !(place.distance <= reach_)) continue;
    found_[found_count_++] = {place, p};
    squared_ += place.distance * place.distance;
  }
  if (is_busy()) return false;
  std::copy_n(found_.begin(), found_count_, matches_.begin());
  count_ = found_count_;
  distance_ = count_ > 0 ? std::sqrt(squared_ / count_) : 0;
  return true;
}

}  // namespace palpate::baselines
