#include "core/elasticity/comparison/shape_matching_model.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Unconstrained.
Body free_bar_without_coupling(mesh::ElementOrder order = mesh::ElementOrder::kLinear) {
  Body body = make_bar({0.2, 0.05, 0.05}, {4, 1, 1}, order, {1e4, 0, 300});
  body.fixed_nodes.clear();
  body.damping = {0, 0};
  return body;
}

TEST(ShapeMatching, RigidMotionIsNotCorrected) {
  for (auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const Body body = free_bar_without_coupling(order);
    ShapeMatchingModel model(body);
    model.prepare();
    const math::Pose X = math::make_pose(rotation(2.8, {1, 2, -1}), Vector3d(0.3, -0.1, 2));
    const Matrix3Xd moved = X * body.mesh.nodes;
    ASSERT_TRUE(model.restore(moved, Matrix3Xd::Zero(3, moved.cols())));
    for (int i = 0; i < 100; ++i) model.step(kDt);
    EXPECT_LT((model.positions() - moved).cwiseAbs().maxCoeff(), 1e-12);
  }
}

/// Eight tetrahedra around a centre: 0 the centre, then the vertices +x -x +y -y +z -z at `radius`.
/// Held at +x, fixed at -x.
Body octahedron(double radius, double modulus) {
  Body body;
  body.mesh.order = mesh::ElementOrder::kLinear;
  body.mesh.corner_count = 7;
  body.mesh.nodes = Matrix3Xd::Zero(3, 7);
  for (int axis = 0; axis < 3; ++axis) {
    body.mesh.nodes(axis, 1 + 2 * axis) = radius;
    body.mesh.nodes(axis, 2 + 2 * axis) = -radius;
  }
  body.mesh.elements.resize(4, 8);
  for (int octant = 0; octant < 8; ++octant) {
    const int x = 1 + (octant & 1), y = 3 + (octant >> 1 & 1), z = 5 + (octant >> 2 & 1);
    const bool mirrored = (octant & 1) ^ (octant >> 1 & 1) ^ (octant >> 2 & 1);
    body.mesh.elements.col(octant) << 0, x, mirrored ? z : y, mirrored ? y : z;
  }
  body.material = {modulus, 0, 300};
  body.damping = {20, 0};
  body.fixed_nodes = {2};
  GraspRegion grasp;
  grasp.nodes = {1};
  body.grasps = {grasp};
  return body;
}

// With two rings every region is the whole octahedron, whose moments are equal along all axes:
// pulled at one vertex it strains uniformly, and V E e^2 / 2 is its energy.
TEST(ShapeMatching, UniformStrainHasTheEnergyThatESays) {
  const double radius = 0.03, modulus = 1e4, strain = 0.04;
  ShapeMatchingOptions options;
  options.rings = 2;
  options.max_substeps = 50;
  ShapeMatchingModel model(octahedron(radius, modulus), options);
  model.prepare();
  math::Pose X = math::Pose::Identity();
  X.translation().x() = 2 * radius * strain;
  model.hold(0, X);
  for (int i = 0; i < 2000; ++i) model.step(kDt);
  Matrix3Xd expected = Vector3d(1 + strain, 1, 1).asDiagonal() * model.body().mesh.nodes;
  expected.row(0).array() += radius * strain;
  EXPECT_LT((model.positions() - expected).norm(), 1e-9);
  const double volume = 4.0 / 3 * std::pow(radius, 3);
  const double force = modulus * volume * strain / (2 * radius);
  EXPECT_NEAR(model.reaction(0).force.x(), force, 1e-6 * force);
}

Body stretched_bar(mesh::ElementOrder order, const std::array<int, 3>& cells, double modulus) {
  Body body = make_bar({0.2, 0.05, 0.05}, cells, order, {modulus, 0, 300});
  body.damping = {20, 0};
  return body;
}

double pull(const Body& body, const ShapeMatchingOptions& options, double dt, double seconds) {
  ShapeMatchingModel model(body, options);
  model.prepare();
  math::Pose X = body.grasps[0].X_OG_rest;
  X.translation().x() += 0.002;
  model.hold(0, X);
  for (int i = 0; i < seconds / dt; ++i) model.step(dt);
  return model.reaction(0).force.x();
}

TEST(ShapeMatching, StretchedBarPullsWithAboutEAOverL) {
  const double expected = 3e4 * 0.05 * 0.05 / 0.2 * 0.002;
  const Body linear = stretched_bar(mesh::ElementOrder::kLinear, {8, 2, 2}, 3e4);
  EXPECT_NEAR(pull(linear, {}, kDt, 2), expected, 0.15 * expected);
  const Body quadratic = stretched_bar(mesh::ElementOrder::kQuadratic, {4, 1, 1}, 3e4);
  EXPECT_NEAR(pull(quadratic, {}, kDt, 2), expected, 0.15 * expected);
}

TEST(ShapeMatching, StiffnessDependsOnTheStepOnlyWhereItSaysSo) {
  const Body body = stretched_bar(mesh::ElementOrder::kLinear, {8, 2, 2}, 1e5);
  ShapeMatchingOptions enough, few;
  enough.max_substeps = 10;
  few.max_substeps = 1;
  ASSERT_EQ(ShapeMatchingModel(body, enough).modulus_share(kDt), 1);
  ASSERT_EQ(ShapeMatchingModel(body, enough).modulus_share(kDt / 3), 1);
  const double force = pull(body, enough, kDt, 2);
  EXPECT_NEAR(pull(body, enough, kDt / 3, 2), force, 1e-3 * force);

  const double share = ShapeMatchingModel(body, few).modulus_share(kDt);
  EXPECT_LT(share, 0.5);
  const double softer = pull(body, few, kDt, 2);
  EXPECT_LT(softer, 0.9 * force);
  EXPECT_GT(softer, share * force);  // the stiffest region is limited most
}

TEST(ShapeMatching, EquilibriumOfForcesAndMoments) {
  Body body = free_bar_without_coupling(mesh::ElementOrder::kQuadratic);
  body.damping.mass_factor = 20;
  GraspRegion other;
  other.nodes = nodes_at(body.mesh, 0, 0);
  body.grasps.push_back(other);
  ShapeMatchingModel model(body);
  model.prepare();
  std::array<math::Pose, 2> X = {body.grasps[0].X_OG_rest, body.grasps[1].X_OG_rest};
  X[0].linear() = rotation(0.5, {1, 2, 0});
  X[0].translation() += Vector3d(-0.03, 0, 0.02);
  for (int g : {0, 1}) model.hold(g, X[g]);
  const Vector3d gravity(0, 1, -9.81);
  model.set_gravity(gravity);
  model.loads()(1, 7) = 0.1;
  for (int i = 0; i < 6000; ++i) model.step(kDt);
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();
  for (int i = 0; i < body.mesh.node_count(); ++i) {
    const Vector3d f = model.masses()(i) * gravity + model.loads().col(i);
    force += f;
    torque += model.positions().col(i).cross(f);
  }
  const Vector3d applied = force;
  for (int g : {0, 1}) {
    const math::Wrench w = model.reaction(g);
    force += w.force;
    torque += w.torque + X[g].translation().cross(w.force);
  }
  EXPECT_LT(force.norm(), 1e-8 * applied.norm());
  // Regions are in balance before the correction, by loads h^2 f / m away from the final positions.
  EXPECT_LT(torque.norm(), 1e-3 * 0.2 * applied.norm());
}

TEST(ShapeMatching, FreeFallAndMomentum) {
  const Body body = free_bar_without_coupling();
  ShapeMatchingModel model(body);
  model.prepare();
  model.set_gravity({0, 0, -9.81});
  Matrix3Xd v = Matrix3Xd::Zero(3, body.mesh.node_count());
  for (int i = 0; i < v.cols(); ++i) v.col(i) = Vector3d(0.2, 0.1 * std::sin(i), 0.1);
  const Matrix3Xd stretched = Vector3d(1.1, 0.9, 1).asDiagonal() * body.mesh.nodes;
  ASSERT_TRUE(model.restore(stretched, v));
  const double mass = model.masses().sum();
  const Vector3d velocity = v * model.masses() / mass;
  const Vector3d centre = stretched * model.masses() / mass;
  const int steps = 100, count = model.substeps(kDt);
  for (int i = 0; i < steps; ++i) model.step(kDt);
  const double t = steps * kDt, h = kDt / count;
  const Vector3d gravity(0, 0, -9.81);
  const Vector3d v_end = model.velocities() * model.masses() / mass;
  EXPECT_LT((v_end - velocity - gravity * t).norm(), 1e-10);
  const Vector3d x_end = model.positions() * model.masses() / mass;
  const Vector3d fall = velocity * t + gravity * (t * t + h * t) / 2;
  EXPECT_LT((x_end - centre - fall).norm(), 1e-10);
}

TEST(ShapeMatching, ReturnsToRest) {
  for (auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    Body body = stretched_bar(order, {4, 1, 1}, 1e4);
    ShapeMatchingModel model(body);
    model.prepare();
    math::Pose X = body.grasps[0].X_OG_rest;
    X.translation() += Vector3d(-0.03, 0, 0.05);
    X.linear() = rotation(-0.8, {0.1, 1, 0});
    model.hold(0, X);
    for (int i = 0; i < 500; ++i) model.step(kDt);
    EXPECT_GT((model.positions() - body.mesh.nodes).colwise().norm().maxCoeff(), 0.04);
    model.release(0);
    for (int i = 0; i < 4000; ++i) model.step(kDt);
    EXPECT_LT((model.positions() - body.mesh.nodes).colwise().norm().maxCoeff(), 1e-6);
  }
}

TEST(ShapeMatching, OptionsOutOfRangeAreRefused) {
  ShapeMatchingOptions options;
  options.rings = 0;
  EXPECT_THROW(ShapeMatchingModel(free_bar_without_coupling(), options), std::invalid_argument);
  options = {};
  options.max_substeps = 0;
  EXPECT_THROW(ShapeMatchingModel(free_bar_without_coupling(), options), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::elasticity
