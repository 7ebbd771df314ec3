#include "tools/lab/baselines/sensing/mass_spring_em.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::baselines {

MassSpringEm::MassSpringEm(const elasticity::Body& body, const mesh::Surface& surface,
                           const Options& options)
    : CloudEstimator(body, surface, options), options_(options), nodes_(surface.nodes) {
  if (!(options.stiffness > 0) || !(options.damping >= 0) || !(options.width > 0) ||
      !(options.noise > 0) || !(options.noise < 1))
    throw std::invalid_argument(
        "mass-spring with correspondence wants stiffness, width > 0, damping >= 0, noise in (0, "
        "1)");
  const auto count = static_cast<Eigen::Index>(nodes_.size());
  for (Eigen::VectorXd* v : {&share_, &weight_, &weight_next_}) v->setZero(count);
  attractor_.setZero(3, count);
  attractor_next_.setZero(3, count);
}

void MassSpringEm::begin(const Eigen::Matrix3Xd&) noexcept {
  points_.resize(3, 0);
  next_ = 0;
  weight_.setZero();
  attractor_.setZero();
}

/// Adds the responsibilities of one point. The density of the noise is that of a fraction `noise`
/// of the points distributed within two widths of a node.
void MassSpringEm::expect(const Eigen::Vector3d& point,
                          const Eigen::Matrix3Xd& positions) noexcept {
  const double scale = -0.5 / (options_.width * options_.width);
  double sum = options_.noise / (1 - options_.noise) * std::exp(-2.0);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    share_[i] = std::exp(scale * (point - positions.col(nodes_[k])).squaredNorm());
    sum += share_[i];
  }
  share_ /= sum;
  weight_next_ += share_;
  for (Eigen::Index i = 0; i < share_.size(); ++i) attractor_next_.col(i) += share_[i] * point;
}

elasticity::StepReport MassSpringEm::advance(double dt, const estimation::EstimationInputs& inputs,
                                             elasticity::DeformationModel& model) noexcept {
  const estimation::ObservationInput& seen = inputs.observation;
  if (seen.freshness == Freshness::kNew && seen.points_O.allFinite()) {
    points_ = seen.points_O;
    next_ = 0;
    weight_next_.setZero();
    attractor_next_.setZero();
  }
  const Eigen::Matrix3Xd& x = model.positions();
  if (next_ < points_.cols()) {
    const Eigen::Index end =
        std::min<Eigen::Index>(next_ + options_.points_per_tick, points_.cols());
    for (; next_ < end; ++next_) expect(points_.col(next_), x);
    if (next_ == points_.cols()) {
      const double share = 1.0 / static_cast<double>(points_.cols());
      weight_ = share * weight_next_;
      attractor_ = share * attractor_next_;
    }
  }
  Eigen::Matrix3Xd& loads = model.loads();
  loads.setZero();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const int node = nodes_[k];
    loads.col(node) = options_.stiffness * (attractor_.col(i) - weight_[i] * x.col(node)) -
                      options_.damping * weight_[i] * model.velocities().col(node);
  }
  return model.step(dt);
}

}  // namespace palpate::baselines
