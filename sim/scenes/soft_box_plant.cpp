#include "sim/scenes/soft_box_plant.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/math/constants.hpp"

namespace palpate::scenes {
namespace {

constexpr double kPeriod = 1e-3;         // s
constexpr double kLongestSettling = 10;  // s, simulated, at most
constexpr double kRest = 1e-8;           // m per step
using math::kPi;
constexpr double kSticking = 0.99;  // of the friction cone

}  // namespace

SoftBoxPlant::SoftBoxPlant(const robot::SoftBoxOptions& options,
                           std::vector<object::FingertipOptions> tips)
    : friction_(options.friction),
      body_(options),
      tips_(std::move(tips)),
      goals_(tips_.size(), Eigen::Vector3d::Zero()),
      touches_(tips_.size()) {
  const int vertices = body_.vertex_count();
  const Eigen::Matrix3Xi& triangles = body_.surface_triangles();
  elements_.resize(4, triangles.cols());
  elements_.topRows<3>() = triangles;
  // Positive: seen from the core the skin triangles are oriented the other way round.
  elements_.row(0).swap(elements_.row(1));
  elements_.row(3).setConstant(vertices);
  clamped_ = {vertices};
  pulls_.setZero(3, vertices);
  read_shape();
  rest_ = positions_;
}

void SoftBoxPlant::read_shape() {
  const int vertices = body_.vertex_count();
  positions_.resize(3, vertices + 1);
  positions_.leftCols(vertices) = body_.positions();
  positions_.col(vertices) = body_.core().translation();
}

void SoftBoxPlant::settle() {
  for (double time = 0; time < kLongestSettling; time += kPeriod) {
    const Eigen::Matrix3Xd before = positions_;
    step(kPeriod);
    if (!positions_.allFinite()) break;
    if ((positions_ - before).cwiseAbs().maxCoeff() < kRest) return;
  }
  throw std::invalid_argument("the object does not come to rest under its weight");
}

void SoftBoxPlant::step(double dt) noexcept {
  for (int i = 0; i < placed_; ++i) body_.move(i, (goals_[i] - body_.probe_position(i)) / dt);
  for (int i = 0; i < pulls_.cols(); ++i) body_.pull(i, pulls_.col(i));
  body_.step(dt);
  read_shape();
  for (int i = 0; i < placed_; ++i) read_touch(i);
}

void SoftBoxPlant::move_fingertip(int tip, const Eigen::Vector3d& centre,
                                  const math::Twist& /*velocity*/) noexcept {
  goals_[tip] = centre;
  if (tip < placed_) return;
  body_.add_sphere(tips_[tip].radius, centre);
  ++placed_;
}

void SoftBoxPlant::read_touch(int tip) {
  const robot::ProbeContact& contact = body_.probe_contact(tip);
  object::FingertipTouch& touch = touches_[tip];
  touch = object::FingertipTouch();
  touch.touching = contact.force.squaredNorm() > 0;
  if (!touch.touching) return;
  touch.force = contact.force;
  touch.point = contact.point;
  touch.normal = (body_.probe_position(tip) - contact.point).normalized();
  const double pressing = touch.force.dot(touch.normal);
  touch.friction = touch.force - pressing * touch.normal;
  touch.depth = contact.depth;
  // Rest area of the spherical cap within the object.
  touch.area = kPi * touch.depth * std::max(0.0, 2 * tips_[tip].radius - touch.depth);
  touch.sticking = touch.friction.norm() < kSticking * friction_ * pressing;
}

math::Wrench SoftBoxPlant::fingertip_wrench(int tip) const {
  const object::FingertipTouch& touch = touches_[tip];
  return {touch.force, (touch.point - fingertip_centre(tip)).cross(touch.force)};
}

void SoftBoxPlant::push(const Eigen::Vector3d& rest_point, const Eigen::Vector3d& force) noexcept {
  int nearest = 0;
  (rest_.leftCols(pulls_.cols()).colwise() - rest_point).colwise().squaredNorm().minCoeff(&nearest);
  pulls_.col(nearest) += force;
}

void SoftBoxPlant::clear_forces() noexcept { pulls_.setZero(); }

}  // namespace palpate::scenes
