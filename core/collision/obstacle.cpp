#include "core/collision/obstacle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

constexpr double kDegenerate = 1e-12;  // m, distance from a centre or an axis

Proximity from_center(const Vector3d& way, double radius, const Vector3d& otherwise) noexcept {
  const double away = way.norm();
  return {away - radius, away > kDegenerate ? Vector3d(way / away) : otherwise};
}

/// From the excess over the bounds of a convex product of intervals: `excess`: signed distances
/// from its faces, `outward`: their normals. Inside the nearest face counts, outside all exceeded.
template <int kFaces>
Proximity from_faces(const std::array<double, kFaces>& excess,
                     const std::array<Vector3d, kFaces>& outward) noexcept {
  int nearest = 0;
  Vector3d way = Vector3d::Zero();
  for (int k = 0; k < kFaces; ++k) {
    if (excess[k] > excess[nearest]) nearest = k;
    if (excess[k] > 0) way += excess[k] * outward[k];
  }
  const double away = way.norm();
  if (away > kDegenerate) return {away, way / away};
  return {excess[nearest], outward[nearest]};
}

Proximity near(const HalfSpace& /*plane*/, const Vector3d& p) noexcept {
  return {p.z(), Vector3d::UnitZ()};
}

Proximity near(const Box& box, const Vector3d& p) noexcept {
  std::array<double, 3> excess;
  std::array<Vector3d, 3> outward;
  for (int axis = 0; axis < 3; ++axis) {
    excess[axis] = std::abs(p[axis]) - box.half_size[axis];
    outward[axis] = std::copysign(1.0, p[axis]) * Vector3d::Unit(axis);
  }
  return from_faces<3>(excess, outward);
}

Proximity near(const Sphere& sphere, const Vector3d& p) noexcept {
  return from_center(p, sphere.radius, Vector3d::UnitZ());
}

Proximity near(const Cylinder& cylinder, const Vector3d& p) noexcept {
  const Proximity mantle = from_center({p.x(), p.y(), 0}, cylinder.radius, Vector3d::UnitX());
  if (!std::isfinite(cylinder.length)) return mantle;
  return from_faces<2>({mantle.distance, std::abs(p.z()) - 0.5 * cylinder.length},
                       {mantle.normal, std::copysign(1.0, p.z()) * Vector3d::UnitZ()});
}

Proximity near(const Capsule& capsule, const Vector3d& p) noexcept {
  const double along = std::clamp(p.z(), -0.5 * capsule.length, 0.5 * capsule.length);
  return from_center(p - along * Vector3d::UnitZ(), capsule.radius, Vector3d::UnitX());
}

Proximity near(const std::shared_ptr<const DistanceGrid>& grid, const Vector3d& p) noexcept {
  return {grid->distance(p), grid->normal(p)};
}

struct InscribedRadius {
  double operator()(const HalfSpace& /*plane*/) const { return kBluntest; }
  double operator()(const Box& box) const { return box.half_size.minCoeff(); }
  double operator()(const Sphere& sphere) const { return sphere.radius; }
  double operator()(const Cylinder& cylinder) const {
    return std::min(cylinder.radius, 0.5 * cylinder.length);
  }
  double operator()(const Capsule& capsule) const { return capsule.radius; }
  double operator()(const std::shared_ptr<const DistanceGrid>& /*grid*/) const { return 0; }
};

struct SizeCheck {
  static bool is_length(double value) { return value > 0 && std::isfinite(value); }
  bool operator()(const HalfSpace& /*plane*/) const { return true; }
  bool operator()(const Box& box) const {
    return is_length(box.half_size.minCoeff()) && box.half_size.allFinite();
  }
  bool operator()(const Sphere& sphere) const { return is_length(sphere.radius); }
  bool operator()(const Cylinder& cylinder) const {
    return is_length(cylinder.radius) && cylinder.length > 0;
  }
  bool operator()(const Capsule& capsule) const {
    return is_length(capsule.radius) && is_length(capsule.length);
  }
  bool operator()(const std::shared_ptr<const DistanceGrid>& grid) const { return grid != nullptr; }
};

Vector3d in_shape(const Obstacle& obstacle, const Vector3d& p_O) noexcept {
  return obstacle.X_OB.linear().transpose() * (p_O - obstacle.X_OB.translation());
}

}  // namespace

void Obstacle::check() const {
  const auto require = [&](bool condition, const char* message) {
    if (!condition) throw std::invalid_argument("obstacle " + name + ": " + message);
  };
  require(std::visit(SizeCheck(), shape), "sizes must be larger than 0 m and finite");
  require(friction >= 0 && std::isfinite(friction), "friction may not be negative");
  require(X_OB.matrix().allFinite(), "its pose is not finite");
  require(V_O_B.vector().allFinite(), "its velocity is not finite");
  require(hand >= -1 && hand <= 1, "hand must be -1, 0 or 1");
}

Proximity proximity(const Obstacle& obstacle, const Vector3d& p_O) noexcept {
  if (!obstacle.is_known) return {std::numeric_limits<double>::infinity(), Vector3d::UnitZ()};
  const Vector3d p = in_shape(obstacle, p_O);
  Proximity result = std::visit([&](const auto& shape) { return near(shape, p); }, obstacle.shape);
  result.normal = obstacle.X_OB.linear() * result.normal;
  return result;
}

double distance(const Obstacle& obstacle, const Vector3d& p_O) noexcept {
  return proximity(obstacle, p_O).distance;
}

double inscribed_radius(const Shape& shape) noexcept {
  return std::min(kBluntest, std::visit(InscribedRadius(), shape));
}

Vector3d normal(const Obstacle& obstacle, const Vector3d& p_O) noexcept {
  return proximity(obstacle, p_O).normal;
}

Eigen::Matrix3d normal_derivative(const Obstacle& obstacle, const Vector3d& p_O) noexcept {
  constexpr double kStep = 1e-6;  // m
  Eigen::Matrix3d derivative;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d step = kStep * Vector3d::Unit(axis);
    derivative.col(axis) =
        (normal(obstacle, p_O + step) - normal(obstacle, p_O - step)) / (2 * kStep);
  }
  return derivative;
}

}  // namespace palpate::collision
