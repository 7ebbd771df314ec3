#include "tools/lab/baselines/sensing/compliance_map.hpp"

#include <cmath>
#include <stdexcept>

#include "core/estimation/nodal_loads.hpp"

namespace palpate::baselines {

using Eigen::Vector3d;

ComplianceProcess::ComplianceProcess(const Options& options) : options_(options) {
  for (const double value : {options.length, options.deviation, options.noise, options.mean})
    if (!(value > 0)) throw std::invalid_argument("options of a Gaussian process must be positive");
}

double ComplianceProcess::kernel(const Vector3d& a, const Vector3d& b) const noexcept {
  const double squared = (a - b).squaredNorm() / (options_.length * options_.length);
  return options_.deviation * options_.deviation * std::exp(-0.5 * squared);
}

void ComplianceProcess::add(const Vector3d& place, double compliance) noexcept {
  if (!(compliance > 0) || !std::isfinite(compliance) || !place.allFinite()) return;
  const double value = std::log(compliance / options_.mean);
  int nearest = 0;
  for (int i = 1; i < count_; ++i)
    if ((places_[i] - place).squaredNorm() < (places_[nearest] - place).squaredNorm()) nearest = i;
  const bool near = count_ > 0 && (places_[nearest] - place).norm() < 0.1 * options_.length;
  if (near || count_ == kMost) {
    places_[nearest] = 0.5 * (places_[nearest] + place);
    values_[nearest] = 0.5 * (values_[nearest] + value);
  } else {
    places_[count_] = place;
    values_[count_++] = value;
  }
  factor();
}

void ComplianceProcess::factor() noexcept {
  lower_.setZero(count_, count_);
  weights_.setZero(count_);
  for (int i = 0; i < count_; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = kernel(places_[i], places_[j]);
      if (i == j) sum += options_.noise * options_.noise;
      for (int k = 0; k < j; ++k) sum -= lower_(i, k) * lower_(j, k);
      lower_(i, j) = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / lower_(j, j);
    }
  for (int i = 0; i < count_; ++i) weights_[i] = values_[i];
  lower_.triangularView<Eigen::Lower>().solveInPlace(weights_);
  lower_.triangularView<Eigen::Lower>().transpose().solveInPlace(weights_);
}

ComplianceProcess::Prediction ComplianceProcess::at(const Vector3d& place) const noexcept {
  Column near = Column::Zero(count_);
  double mean = 0;
  for (int i = 0; i < count_; ++i) {
    near[i] = kernel(place, places_[i]);
    mean += near[i] * weights_[i];
  }
  if (count_ > 0) lower_.triangularView<Eigen::Lower>().solveInPlace(near);
  const double variance = options_.deviation * options_.deviation - near.squaredNorm();
  return {options_.mean * std::exp(mean), std::sqrt(std::max(0.0, variance))};
}

Eigen::Index ComplianceProcess::least_known(const Eigen::Matrix3Xd& places) const noexcept {
  Eigen::Index least = 0;
  double largest = -1;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const double deviation = at(places.col(i)).deviation;
    if (deviation > largest) least = i;
    largest = std::max(largest, deviation);
  }
  return least;
}

ComplianceMap::ComplianceMap(const elasticity::Body& body, const mesh::Surface& surface,
                             const Options& options)
    : ShapePredictor(body),
      options_(options),
      process_(options.process),
      matcher_(surface),
      fixed_(body.fixed_nodes) {
  if (!(options.footprint > 0) || !(options.least_force > 0) || !(options.every > 0))
    throw std::invalid_argument("options of a compliance map must be positive");
  matcher_.take(rest());
}

void ComplianceMap::reset() noexcept {
  ShapePredictor::reset();
  process_.clear();
  since_ = 0;
}

UpdateResult ComplianceMap::predict(const estimation::EstimationInputs& inputs, double step,
                                    Eigen::Matrix3Xd& shape,
                                    estimation::Estimate& /*estimate*/) noexcept {
  since_ += step;
  const bool learns = since_ >= options_.every;
  if (learns) since_ = 0;
  shape = rest();
  for (int i = 0; i < inputs.contact_count; ++i) {
    const contact::ContactLoads& touch = inputs.contacts[i];
    if (!touch.accepted || sensing::is_wrist(touch.source)) continue;
    Vector3d force = Vector3d::Zero();
    for (const contact::NodalLoad& load : touch.loads)
      if (estimation::is_valid(load, static_cast<int>(shape.cols()))) force += load.force;
    const contact::SurfaceMatch place = matcher_.find(touch.location);
    const double pressed = -place.normal.dot(force);
    if (place.count == 0 || !(pressed > options_.least_force)) continue;
    const double depth = place.normal.dot(place.position - touch.location);
    if (learns && depth > 0) process_.add(place.position, depth / pressed);
    const double gives = process_.at(place.position).compliance * pressed;
    const double scale = -0.5 / (options_.footprint * options_.footprint);
    for (Eigen::Index n = 0; n < shape.cols(); ++n)
      shape.col(n) -=
          gives * std::exp(scale * (rest().col(n) - place.position).squaredNorm()) * place.normal;
  }
  for (const int node : fixed_) shape.col(node) = rest().col(node);
  return {};
}

}  // namespace palpate::baselines
