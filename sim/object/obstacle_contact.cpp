#include "sim/object/obstacle_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::object {
namespace {

constexpr double kReachAbove = 5e-4;             // m, above the surface: may touch within a step
constexpr double kObstacleShearStiffness = 0.5;  // relative to the normal stiffness
constexpr double kSamplesPerCylinderRadius = 6;  // of a cylinder, along a line
constexpr double kShortest = 1e-9;               // of a direction

Eigen::Vector3d unit(const Eigen::Vector3d& direction, const char* name) {
  if (!direction.allFinite() || !(direction.norm() > kShortest))
    throw std::invalid_argument(std::string("plant: an obstacle needs a ") + name +
                                " other than zero");
  return direction.normalized();
}

/// Greatest distance of the surface samples, m.
double spacing(const HalfSpace& /*plane*/) { return std::numeric_limits<double>::infinity(); }
double spacing(const Cylinder& cylinder) { return cylinder.radius / kSamplesPerCylinderRadius; }

ObstacleOptions checked(ObstacleOptions options) {
  if (!(options.stiffness > 0) || !(options.friction >= 0) || !(options.damping >= 0))
    throw std::invalid_argument(
        "plant: an obstacle needs stiffness > 0, friction >= 0 and damping >= 0");
  if (auto* plane = std::get_if<HalfSpace>(&options.shape)) {
    plane->normal = unit(plane->normal, "normal");
  } else {
    auto& cylinder = std::get<Cylinder>(options.shape);
    cylinder.axis = unit(cylinder.axis, "axis");
    if (!(cylinder.radius > 0) || !(cylinder.length > 0))
      throw std::invalid_argument("plant: a cylinder needs radius > 0 and length > 0");
  }
  return options;
}

/// The points within `ahead` of an obstacle.
template <class Shape>
struct Vicinity {
  bool meets(const Box& box) const noexcept {
    return within(0.5 * (box.lower + box.upper), 0.5 * (box.upper - box.lower).norm());
  }
  bool within(const Eigen::Vector3d& p, double margin) const noexcept {
    return shape.distance(p) <= ahead + margin;
  }

  const Shape& shape;
  double ahead;
};

struct Everywhere {
  bool meets(const Box& /*box*/) const noexcept { return true; }
  bool within(const Eigen::Vector3d& /*p*/, double /*margin*/) const noexcept { return true; }
};

void add_row_sums(const ContactSurface& surface, const SurfaceSample& sample, double rate,
                  Eigen::VectorXd& stiffness) noexcept {
  for (int b = 0; b < 9; ++b) {
    stiffness[surface.node(sample.face, b)] +=
        ContactSurface::kWeightSum * rate * std::abs(sample.weights[b]);
  }
}

}  // namespace

double Cylinder::distance(const Eigen::Vector3d& p) const noexcept {
  const Eigen::Vector3d from = p - point;
  const double along = axis.dot(from);
  return std::max((from - along * axis).norm() - radius, std::abs(along) - 0.5 * length);
}

Eigen::Vector3d Cylinder::outward(const Eigen::Vector3d& p) const noexcept {
  const Eigen::Vector3d from = p - point;
  const double along = axis.dot(from);
  const Eigen::Vector3d across = from - along * axis;
  const double away = across.norm();
  if (std::abs(along) - 0.5 * length > away - radius) return std::copysign(1.0, along) * axis;
  return away > 0 ? Eigen::Vector3d(across / away) : Eigen::Vector3d(axis.unitOrthogonal());
}

ObstacleContact::ObstacleContact(const ObstacleOptions& options, const HexahedralGrid& grid)
    : options_(checked(options)),
      surface_(grid, std::visit([](const auto& shape) { return spacing(shape); }, options_.shape),
               ContactSurface::Rule::kGauss),
      shear_stiffness_(kObstacleShearStiffness * options.stiffness),
      tractions_(Eigen::Matrix3Xd::Zero(3, surface_.sample_count())),
      pressed_(surface_.sample_count(), -1) {}

Eigen::VectorXd ObstacleContact::greatest_stiffness(const Eigen::Matrix3Xd& positions) const {
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(positions.cols());
  surface_.for_each_in(Everywhere(), positions, [&](const SurfaceSample& sample) {
    add_row_sums(surface_, sample, options_.stiffness * sample.area, stiffness);
  });
  return stiffness;
}

/// Traction of a sample under pressure, after its spring has followed the material.
Eigen::Vector3d ObstacleContact::friction_at(const SurfaceSample& sample, double pressure,
                                             const Eigen::Vector3d& normal,
                                             const Eigen::Vector3d& velocity, double h) noexcept {
  Eigen::Vector3d traction = tractions_.col(sample.index);
  if (pressed_[sample.index] != call_ - 1) traction.setZero();
  pressed_[sample.index] = call_;
  traction -= shear_stiffness_ * h * velocity;
  traction -= normal.dot(traction) * normal;
  const double size = traction.norm(), most = options_.friction * pressure;
  if (size > most) {
    traction *= most / size;
    touch_.slipping += sample.area;
  }
  tractions_.col(sample.index) = traction;
  return traction;
}

template <class Shape>
void ObstacleContact::press(const Shape& shape, const Eigen::Matrix3Xd& positions,
                            const Eigen::Matrix3Xd& velocities, double h, Eigen::Matrix3Xd& forces,
                            Eigen::VectorXd& stiffness) noexcept {
  surface_.for_each_in(
      Vicinity<Shape>{shape, kReachAbove}, positions, [&](const SurfaceSample& sample) {
        const double rate = options_.stiffness * sample.area;
        const double depth = -shape.distance(sample.position);
        if (!(depth > 0)) {
          add_row_sums(surface_, sample, rate, stiffness);
          return;
        }
        Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
        for (int b = 0; b < 9; ++b)
          velocity += sample.weights[b] * velocities.col(surface_.node(sample.face, b));
        const Eigen::Vector3d normal = shape.outward(sample.position);
        const double growth = std::max(0.0, 1 - options_.damping * normal.dot(velocity));
        // A damper d, its velocity half a step old, limits the step h like the stiffness 2 d / h.
        const double damper = h > 0 ? 2 * options_.damping * depth / h : 0;
        add_row_sums(surface_, sample, rate * (std::max(1.0, growth) + damper), stiffness);

        const double pressure = options_.stiffness * depth * growth;
        const Eigen::Vector3d traction = friction_at(sample, pressure, normal, velocity, h);
        const Eigen::Vector3d force = sample.area * (pressure * normal + traction);
        for (int b = 0; b < 9; ++b)
          forces.col(surface_.node(sample.face, b)) += sample.weights[b] * force;
        touch_.touching = true;
        touch_.wrench.force += force;
        touch_.wrench.torque += sample.position.cross(force);
        touch_.area += sample.area;
        touch_.depth = std::max(touch_.depth, depth);
        energy_ += 0.5 * rate * depth * depth +
                   0.5 * sample.area / shear_stiffness_ * traction.squaredNorm();
      });
}

void ObstacleContact::add_forces(const Eigen::Matrix3Xd& positions,
                                 const Eigen::Matrix3Xd& velocities, double h,
                                 Eigen::Matrix3Xd& forces, Eigen::VectorXd& stiffness) noexcept {
  ++call_;
  touch_ = ObstacleTouch();
  energy_ = 0;
  std::visit([&](const auto& shape) { press(shape, positions, velocities, h, forces, stiffness); },
             options_.shape);
}

}  // namespace palpate::object
