#include "core/estimation/surface_fit.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::estimation {

using Eigen::Vector3d;

namespace {

/// Median distance from a sample of the points to their nearest neighbours, m.
double spacing_of(const ObservationInput::Points& points) noexcept {
  constexpr int kSome = 16;
  std::array<double, kSome> nearest{};
  const Eigen::Index count = points.cols();
  if (count < kSome) return 0;
  for (int i = 0; i < kSome; ++i) {
    const Eigen::Index own = i * count / kSome;
    double least = 1e300;
    for (Eigen::Index k = 0; k < count; ++k)
      if (k != own) least = std::min(least, (points.col(k) - points.col(own)).squaredNorm());
    nearest[static_cast<std::size_t>(i)] = least;
  }
  std::nth_element(nearest.begin(), nearest.begin() + kSome / 2, nearest.end());
  return std::sqrt(nearest[kSome / 2]);
}

}  // namespace

SurfaceFit::SurfaceFit(const Eigen::Matrix3Xd& rest, const mesh::Surface& surface,
                       const Options& options)
    : options_(options), matcher_(surface), edges_(rest, surface) {
  math::check_positive(options.lag_deviation, "lag_deviation");
  math::check_positive(options.correlation, "correlation");
  math::check_positive(options.gate, "gate");
  math::check_positive(options.reach, "reach");
  math::check_option(options.lag >= 0 && options.lag < ShapeHistory::kLongest, "lag", options.lag,
                     "0 to below " + std::to_string(ShapeHistory::kLongest));
  math::check_not_negative(options.surface, "surface");
  math::check_not_negative(options.edge_band, "edge_band");
  math::check_not_negative(options.edge, "edge");
  math::check_option(options.places >= 1, "places", options.places, "at least 1");
  math::check_option(options.points_per_tick >= 1, "points_per_tick", options.points_per_tick,
                     "at least 1");
  moment_.positions.setZero(3, rest.cols());
  moment_.velocities.setZero(3, rest.cols());
}

void SurfaceFit::reset() noexcept {
  points_.resize(3, 0);
  next_ = 0;
  since_ = 0;
  scale_ = -1;
  spares_edges_ = false;
}

bool SurfaceFit::begin(const ObservationInput& seen, const ShapeHistory& history) noexcept {
  interval_ = std::clamp(since_, 1e-3, options_.correlation);
  since_ = 0;
  points_.resize(3, 0);
  next_ = 0;
  if (!(seen.deviation > 0 && std::isfinite(seen.deviation)) || seen.points_O.cols() == 0 ||
      !seen.points_O.allFinite() || !history.recall(options_.lag, moment_))
    return false;
  points_ = seen.points_O;
  deviation_ = seen.deviation;
  const double per_place = std::max(1.0, static_cast<double>(points_.cols()) / options_.places);
  common_count_ = per_place * options_.correlation / interval_;
  edge_band_ = options_.edge_band * spacing_of(points_);
  matcher_.take(moment_.positions);
  residual_count_ = edge_count_ = 0;
  information_.used = information_.rejected = 0;
  information_.matrix.resize(0, 0);
  return true;
}

bool SurfaceFit::advance(const Basis& basis, double dt) noexcept {
  since_ += dt;
  const int size = basis.filter->shape_size();
  if (information_.matrix.cols() != size) {
    information_.matrix = WrenchFilter::ShapeMatrix::Zero(size, size);
    information_.vector = WrenchFilter::ShapeState::Zero(size);
  }
  const Eigen::Index end = std::min<Eigen::Index>(points_.cols(), next_ + options_.points_per_tick);
  for (; next_ < end; ++next_) take(points_.col(next_), basis);
  if (is_busy()) return false;
  close_message();
  return true;
}

void SurfaceFit::add_node(const Basis& basis, int node, double weight, NodeRows& rows) noexcept {
  const elasticity::Sensitivity& s = *basis.sensitivity;
  const WrenchFilter& filter = *basis.filter;
  for (int g = 0; g < filter.grasp_count(); ++g) {
    if (basis.held[g])
      rows.middleCols<6>(filter.offset(g)) += weight * s.dx_dxi[g].middleRows<3>(3 * node);
  }
  rows.col(filter.log_young()) +=
      weight * s.dx_dparameter.middleRows<3>(3 * node).col(elasticity::Sensitivity::kLogYoung);
  const Eigen::Index free = std::min<Eigen::Index>(filter.free_directions(), s.dx_dobstacle.cols());
  rows.middleCols(filter.obstacle(), free) += weight * s.dx_dobstacle.block(3 * node, 0, 3, free);
  for (int k = 0; k < VirtualLoads::kCount; ++k)
    rows.middleCols<3>(filter.load() + 3 * k) += weight * s.dx_dforce[k].middleRows<3>(3 * node);
}

void SurfaceFit::take(const Vector3d& p, const Basis& basis) noexcept {
  const WrenchFilter& filter = *basis.filter;
  const contact::SurfaceMatch match = matcher_.find(p);
  if (match.count == 0 || match.normal.isZero(0)) return;
  if (edges_.is_near(match, options_.edge * deviation_)) {
    ++edge_count_;
    if (spares_edges_) return;
  }
  rows_.setZero(3, filter.shape_size());
  Vector3d velocity = Vector3d::Zero();
  for (int i = 0; i < match.count; ++i) {
    add_node(basis, match.nodes[i], match.weights[i], rows_);
    velocity += match.weights[i] * moment_.velocities.col(match.nodes[i]);
  }
  const WrenchFilter::ShapeState by_patch = rows_.transpose() * match.normal;
  const WrenchFilter::ShapeState h = basis.motion->by_state().transpose() * by_patch;
  const double z = match.normal.dot(p - match.position) + h.dot(moment_.state);
  const double y = z - h.dot(filter.mean().head(filter.shape_size()));
  const double late = match.normal.dot(velocity) * options_.lag_deviation;
  const double own = deviation_ * deviation_ + late * late;
  WrenchFilter::ShapeState Ph = WrenchFilter::ShapeState::Zero(h.size());
  Ph.noalias() = filter.covariance().topLeftCorner(h.size(), h.size()) * h;
  if (!std::isfinite(z) || !h.allFinite()) return;

  // if most residuals exceed their expected size, the state is wrong rather than the points
  residuals_[static_cast<std::size_t>(residual_count_++)] = std::abs(y);
  const double plain = std::sqrt(own + options_.surface * options_.surface);
  const double expected = std::sqrt(plain * plain + h.dot(Ph));
  const double spread = std::max(expected, scale_);
  const double aside = (p - match.position - (z - h.dot(moment_.state)) * match.normal).norm();
  if (std::max(std::abs(y), aside) > std::min(options_.gate * spread, options_.reach)) {
    ++information_.rejected;
    return;
  }
  // Huber weight: limits the influence of residuals beyond 1.5 standard deviations.
  constexpr double kHuber = 1.5;
  const double usual = kHuber * std::max(plain, scale_ < 0 ? expected : scale_);
  const double trust = std::min(1.0, usual / std::max(std::abs(y), 1e-12));
  constexpr double kMostAtEdge = 9;  // upper limit as a multiple of the variance of the surface
  double lasting = options_.surface * options_.surface;
  if (edges_.is_near(match, edge_band_)) lasting = std::clamp(own, lasting, kMostAtEdge * lasting);
  const double weight = trust / (own + common_count_ * lasting);
  information_.matrix.noalias() += (weight * h) * h.transpose();
  information_.vector += weight * z * h;
  ++information_.used;
}

void SurfaceFit::close_message() noexcept {
  spares_edges_ = 2 * edge_count_ < points_.cols();
  if (residual_count_ == 0) return;
  const auto middle = residuals_.begin() + residual_count_ / 2;
  std::nth_element(residuals_.begin(), middle, residuals_.begin() + residual_count_);
  constexpr double kDeviationPerMedian = 1.4826;  // of the magnitude of a normal variable
  scale_ = kDeviationPerMedian * *middle;
}

}  // namespace palpate::estimation
