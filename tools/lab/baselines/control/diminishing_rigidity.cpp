#include "tools/lab/baselines/control/diminishing_rigidity.hpp"

#include <cmath>
#include <stdexcept>

#include "core/control/jacobian_providers.hpp"
#include "tools/lab/baselines/control/geodesic.hpp"

namespace palpate::baselines {
namespace {

/// m, smallest displacement of the hand that defines a direction of motion: above the tremor of an
/// arm at rest.
constexpr double kLeastWay = 1e-4;

}  // namespace

DiminishingRigidity::DiminishingRigidity(const Options& options, const elasticity::Body& body,
                                         int grasp)
    : options_(options) {
  for (const double k : {options.translation, options.rotation, options.push}) {
    if (!(k >= 0 && k <= 1e4)) throw std::invalid_argument("a rigidity must lie in [0, 1e4] 1/m");
  }
  if (grasp < 0 || grasp >= static_cast<int>(body.grasps.size()))
    throw std::invalid_argument("nothing is grasped");
  const std::vector<double> distance = geodesic_distances(body.mesh, body.grasps[grasp].nodes);
  for (const double d : distance) {
    translation_.push_back(std::exp(-options.translation * d));
    rotation_.push_back(std::exp(-options.rotation * d));
    push_.push_back(std::exp(-options.push * d));
  }
}

void DiminishingRigidity::observe(const control::Experience& now) noexcept {
  positions_ = now.positions;
  const Eigen::Vector3d p = now.X_OG.translation();
  if (!moves_) {
    moves_ = true;
    last_ = p;
    way_.setZero();
  }
  if ((p - last_).norm() < kLeastWay) return;
  way_ = (p - last_).normalized();
  last_ = p;
}

bool DiminishingRigidity::update(const shape::Feature& feature,
                                 const elasticity::DeformationModel& model, const math::Pose& X_OG,
                                 Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  const Eigen::Matrix3Xd& positions = positions_ != nullptr ? *positions_ : model.positions();
  if (positions.cols() != static_cast<Eigen::Index>(translation_.size())) return false;
  const Eigen::Vector3d p_OG = X_OG.translation();
  control::accumulate_support(
      feature,
      [&](int node) {
        const Eigen::Vector3d r = positions.col(node) - p_OG;
        Eigen::Matrix3d follow = translation_[node] * Eigen::Matrix3d::Identity();
        const double length = r.norm();
        if (options_.push > 0 && length > 1e-6 && way_.dot(r) > 0)
          follow += (push_[node] - translation_[node]) / (length * length) * r * r.transpose();
        Eigen::Matrix<double, 3, 6> motion;
        motion << follow, -rotation_[node] * math::cross_matrix(r);
        return motion;
      },
      J);
  return J.allFinite();
}

}  // namespace palpate::baselines
