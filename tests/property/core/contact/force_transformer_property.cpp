#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "core/contact/area_coordinates.hpp"
#include "core/contact/wrench_patch.hpp"

namespace palpate::contact {
namespace {

double real(double lower, double upper) {
  constexpr int kSteps = 1000000;
  return lower + (upper - lower) * (*rc::gen::inRange(0, kSteps + 1)) / kSteps;
}

Eigen::Vector3d vector(double size) {
  const double x = real(-size, size), y = real(-size, size), z = real(-size, size);
  return {x, y, z};
}

/// A box of random size and element order, bent by a random smooth map and slightly perturbed.
struct DeformedBox {
  DeformedBox()
      : size(real(0.05, 0.5), real(0.05, 0.2), real(0.05, 0.2)),
        mesh(mesh::make_element_mesh(
            mesh::make_box(size, {3, 2, 2}),
            *rc::gen::element(mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic))),
        surface(mesh::extract_surface(mesh)),
        positions(mesh.nodes) {
    const Eigen::Matrix3d rotation = math::exp_rotation(vector(3));
    const Eigen::Vector3d translation = vector(1);
    const double bend = real(-0.5, 0.5);
    for (int i = 0; i < positions.cols(); ++i) {
      Eigen::Vector3d p = positions.col(i);
      p.z() += bend * p.x() * p.x();
      positions.col(i) = rotation * p + translation + vector(1e-3);
    }
  }

  /// A point of the deformed surface.
  Eigen::Vector3d surface_point() const {
    const int t = *rc::gen::inRange(0, static_cast<int>(surface.triangles.cols()));
    double a = real(0, 1), b = real(0, 1);
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    return (1 - a - b) * positions.col(surface.triangles(0, t)) +
           a * positions.col(surface.triangles(1, t)) + b * positions.col(surface.triangles(2, t));
  }

  Eigen::Vector3d size;
  mesh::ElementMesh mesh;
  mesh::Surface surface;
  Eigen::Matrix3Xd positions;
};

math::Wrench sum(const ContactLoads& loads, const Eigen::Matrix3Xd& positions,
                 const Eigen::Vector3d& about) {
  math::Wrench total;
  for (const NodalLoad& load : loads.loads) {
    total.force += load.force;
    total.torque += (positions.col(load.node) - about).cross(load.force);
  }
  return total;
}

RC_GTEST_PROP(AreaCoordinatesProperty, WeightsAreAPartitionOfUnityAndReproduceThePoint, ()) {
  const DeformedBox box;
  AreaCoordinates transformer(box.mesh, box.surface, {});
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = box.surface_point();
  contact.wrench.force = Eigen::Vector3d::UnitX();  // loads are the weights
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.positions, loads);
  RC_ASSERT(loads.accepted);
  double total = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (const NodalLoad& load : loads.loads) {
    RC_ASSERT(load.force.x() >= 0);
    total += load.force.x();
    point += load.force.x() * box.positions.col(load.node);
  }
  RC_ASSERT(std::abs(total - 1) < 1e-12);
  RC_ASSERT((point - contact.location).norm() < 1e-9);
}

RC_GTEST_PROP(AreaCoordinatesProperty, KeepsForceAndItsMomentAboutTheProjectedPoint, ()) {
  const DeformedBox box;
  AreaCoordinates::Options options;
  options.collision_distance = 1;
  AreaCoordinates transformer(box.mesh, box.surface, options);
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = box.surface_point() + vector(0.05);
  contact.wrench.force = vector(10);
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.positions, loads);
  RC_ASSERT(loads.accepted);
  const mesh::SurfacePoint projected =
      mesh::closest_point_on_surface(contact.location, box.surface.triangles, box.positions);
  const math::Wrench total = sum(loads, box.positions, projected.position);
  RC_ASSERT((total.force - contact.wrench.force).norm() < 1e-10);
  RC_ASSERT(total.torque.norm() < 1e-10);
}

RC_GTEST_PROP(ClosestPointProperty, NoPointOfTheTriangleIsNearer, ()) {
  const Eigen::Vector3d p = vector(2), a = vector(1), b = vector(1), c = vector(1);
  const mesh::SurfacePoint found = mesh::closest_point_on_triangle(p, a, b, c);
  RC_ASSERT(found.weights.minCoeff() >= 0);
  RC_ASSERT(std::abs(found.weights.sum() - 1) < 1e-12);
  const Eigen::Vector3d q = found.weights[0] * a + found.weights[1] * b + found.weights[2] * c;
  RC_ASSERT((q - found.position).norm() < 1e-12);
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; i + j <= 20; ++j) {
      const Eigen::Vector3d other = a + i / 20.0 * (b - a) + j / 20.0 * (c - a);
      RC_ASSERT((other - p).norm() >= found.distance - 1e-9);
    }
}

RC_GTEST_PROP(WrenchPatchProperty, KeepsForceAndTorqueAboutTheContact, ()) {
  const DeformedBox box;
  WrenchPatch::Options options;
  options.radius = real(0.01, 0.2);
  WrenchPatch transformer(box.mesh, box.surface, options);
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = box.surface_point() + vector(0.005);
  contact.wrench = {vector(20), vector(2)};
  ContactLoads loads;
  loads.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.positions, loads);
  RC_ASSERT(loads.accepted);
  const math::Wrench total = sum(loads, box.positions, contact.location);
  double scale = 0;
  for (const NodalLoad& load : loads.loads) scale += load.force.norm();
  RC_ASSERT((total.force - contact.wrench.force).norm() < 1e-12 * scale + 1e-12);
  RC_ASSERT((total.torque - contact.wrench.torque).norm() < 1e-12 * scale + 1e-12);
}

/// A rigid motion of object and contact rotates the loads and changes nothing else.
RC_GTEST_PROP(WrenchPatchProperty, TurnsWithTheObject, ()) {
  const DeformedBox box;
  WrenchPatch transformer(box.mesh, box.surface, {});
  sensing::Contact contact;
  contact.source = sensing::Source::kFinger0;
  contact.location = box.surface_point();
  contact.wrench = {vector(20), vector(2)};
  ContactLoads loads, turned;
  loads.loads.reserve(transformer.max_nodes());
  turned.loads.reserve(transformer.max_nodes());
  transformer.distribute(contact, box.positions, loads);

  const math::Pose X = math::make_pose(math::exp_rotation(vector(3)), vector(1));
  sensing::Contact moved = contact;
  moved.location = X * contact.location;
  moved.wrench = {X.linear() * contact.wrench.force, X.linear() * contact.wrench.torque};
  transformer.distribute(moved, X * box.positions, turned);
  RC_ASSERT(loads.accepted && turned.accepted);
  RC_ASSERT(loads.loads.size() == turned.loads.size());
  for (std::size_t i = 0; i < loads.loads.size(); ++i) {
    RC_ASSERT(loads.loads[i].node == turned.loads[i].node);
    const double size = loads.loads[i].force.norm() + 1;
    RC_ASSERT((X.linear() * loads.loads[i].force - turned.loads[i].force).norm() < 1e-6 * size);
  }
}

}  // namespace
}  // namespace palpate::contact
