#include "sim/object/fingertip_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::object {
namespace {

/// Samples up to this fraction of the radius above the sphere count as stiff: they may touch within
/// a step.
constexpr double kLookAhead = 0.05;

}  // namespace

FingertipContact::FingertipContact(const FingertipOptions& options, const ContactSurface& surface)
    : options_(options) {
  if (!(options.radius > 0) || !(options.stiffness > 0) || !(options.shear_stiffness > 0) ||
      !(options.friction >= 0)) {
    throw std::invalid_argument(
        "plant: a fingertip needs radius and stiffnesses > 0 and friction >= 0");
  }
  shares_.reserve(surface.face_count());
}

void FingertipContact::send(const Eigen::Vector3d& centre, const math::Twist& velocity) noexcept {
  if (!present_) centre_ = centre;
  present_ = true;
  end_ = centre;
  end_velocity_ = velocity;
}

void FingertipContact::begin() noexcept { start_ = centre_; }

void FingertipContact::advance(double s) noexcept {
  centre_ = (1 - s) * start_ + s * end_;
  velocity_ = end_velocity_;
}

void FingertipContact::end() noexcept { end_velocity_ = math::Twist(); }

void FingertipContact::stop() noexcept {
  end_ = centre_;
  velocity_ = end_velocity_ = math::Twist();
}

void FingertipContact::press(const ContactSurface& surface, const Eigen::Matrix3Xd& positions,
                             Eigen::Matrix3Xd& forces, Eigen::VectorXd& stiffness) noexcept {
  shares_.clear();
  pressing_ = stored_ = 0;
  normal_.setZero();
  touch_.area = touch_.depth = 0;
  touch_.point.setZero();
  const double ahead = kLookAhead * options_.radius;
  surface.for_each_in(Ball{centre_, options_.radius + ahead}, positions,
                      [&](const SurfaceSample& sample) {
                        const Eigen::Vector3d outward = sample.position - centre_;
                        const double distance = outward.norm();
                        const double depth = options_.radius - distance;
                        if (depth <= -ahead) return;
                        const double rate = options_.stiffness * sample.area;
                        for (int b = 0; b < 9; ++b) {
                          stiffness[surface.node(sample.face, b)] +=
                              ContactSurface::kWeightSum * rate * std::abs(sample.weights[b]);
                        }
                        if (depth <= 0 || distance <= 0) return;
                        const double size = rate * depth;
                        const Eigen::Vector3d force = size / distance * outward;
                        for (int b = 0; b < 9; ++b)
                          forces.col(surface.node(sample.face, b)) += sample.weights[b] * force;
                        if (shares_.empty() || shares_.back().face != sample.face)
                          shares_.push_back({sample.face, Eigen::Matrix<double, 9, 1>::Zero()});
                        shares_.back().weights += size * sample.weights;
                        normal_ += force;
                        pressing_ += size;
                        stored_ += 0.5 * size * depth;
                        touch_.point += size * sample.position;
                        touch_.area += sample.area;
                        touch_.depth = std::max(touch_.depth, depth);
                      });
}

void FingertipContact::drag(const ContactSurface& surface, const Eigen::Matrix3Xd& velocities,
                            double h, Eigen::Matrix3Xd& forces,
                            Eigen::VectorXd& stiffness) noexcept {
  Eigen::Vector3d slide =
      velocity_.linear +
      velocity_.angular.cross(touch_.point - centre_);  // tip relative to the material
  for (const Share& share : shares_)
    for (int b = 0; b < 9; ++b)
      slide -= share.weights[b] / pressing_ * velocities.col(surface.node(share.face, b));
  const double shear = options_.shear_stiffness * touch_.area;
  if (shear < shear_) traction_ *= shear / shear_;
  shear_ = shear;
  traction_ += shear_ * h * slide;
  traction_ -= touch_.normal * touch_.normal.dot(traction_);
  const double size = traction_.norm();
  const double most = options_.friction * normal_.norm();
  touch_.sticking = size <= most;
  if (!touch_.sticking) {
    traction_ *= most / size;
    touch_.slipped += (size - most) / shear_;
  }
  for (const Share& share : shares_) {
    for (int b = 0; b < 9; ++b) {
      const int node = surface.node(share.face, b);
      const double weight = share.weights[b] / pressing_;
      forces.col(node) += weight * traction_;
      stiffness[node] += ContactSurface::kWeightSum * shear_ * std::abs(weight);
    }
  }
}

void FingertipContact::add_forces(const ContactSurface& surface, const Eigen::Matrix3Xd& positions,
                                  const Eigen::Matrix3Xd& velocities, double h,
                                  Eigen::Matrix3Xd& forces, Eigen::VectorXd& stiffness) noexcept {
  if (!present_) return;
  const bool touched = touch_.touching;
  press(surface, positions, forces, stiffness);
  const double size = normal_.norm();
  touch_.touching = size > 0;
  if (!touch_.touching) {
    traction_.setZero();
    touch_ = FingertipTouch();
    return;
  }
  if (!touched) touch_.slipped = 0;
  touch_.point /= pressing_;
  touch_.normal = normal_ / -size;
  drag(surface, velocities, h, forces, stiffness);
  touch_.friction = -traction_;
  touch_.force = -(normal_ + traction_);
}

math::Wrench FingertipContact::wrench() const noexcept {
  math::Wrench wrench;
  if (!touch_.touching) return wrench;
  wrench.force = touch_.force;
  wrench.torque =
      (touch_.point - centre_).cross(touch_.friction);  // normal forces intersect the centre
  return wrench;
}

double FingertipContact::energy() const noexcept {
  return touch_.touching ? stored_ + 0.5 * traction_.squaredNorm() / shear_ : 0;
}

}  // namespace palpate::object
