#include "core/elasticity/comparison/mass_spring_model.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kMassSpringModelDt = 1e-3;  // s

/// Unconstrained.
Body free_bar(mesh::ElementOrder order = mesh::ElementOrder::kLinear) {
  Body body = make_bar({0.2, 0.05, 0.05}, {4, 1, 1}, order, {1e4, 0.25, 300});
  body.fixed_nodes.clear();
  body.damping = {0, 0};
  return body;
}

MassSpringOptions exact() {
  MassSpringOptions options;
  options.iterations = 50;
  options.tolerance = 1e-11;
  options.cg_iterations = 2000;
  return options;
}

double kinetic_energy(const MassSpringModel& model) {
  return 0.5 * model.masses().dot(model.velocities().colwise().squaredNorm().transpose());
}

TEST(MassSpring, RegularTetrahedronHasTheSpringsOfLloydEtAl) {
  const double edge = 0.03, modulus = 2e4;
  Body body;
  body.mesh.order = mesh::ElementOrder::kLinear;
  body.mesh.corner_count = 4;
  body.mesh.nodes.resize(3, 4);
  body.mesh.nodes << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  body.mesh.nodes *= edge / std::sqrt(8);
  body.mesh.elements = Eigen::Vector4i(0, 1, 3, 2);
  body.material.young_modulus = modulus;
  const MassSpringModel model(body);
  ASSERT_EQ(model.springs().size(), 6u);
  for (const auto& spring : model.springs()) {
    EXPECT_NEAR(spring.length, edge, 1e-12);
    const double expected = 2 * std::sqrt(2) / 25 * edge * modulus;
    EXPECT_NEAR(spring.stiffness, expected, 1e-12 * expected);
  }
}

// The complete elasticity tensors, entry by entry, on a tetrahedron without symmetry.
TEST(MassSpring, SpringShareIsTheNearestInTheFrobeniusNorm) {
  Eigen::Matrix<double, 3, 4> x;
  x << 0, 1, 0.2, 0.1, 0, 0.1, 1.4, 0.3, 0, -0.2, 0.1, 0.8;
  const double mu = 0.4, lambda = 0.4;  // E = 1, nu = 1/4
  const auto distance = [&](double s) {
    double sum = 0;
    for (int code = 0; code < 81; ++code) {
      const int i = code % 3, j = code / 3 % 3, k = code / 9 % 3, l = code / 27;
      double c = -lambda * (i == j) * (k == l) - mu * ((i == k) * (j == l) + (i == l) * (j == k));
      for (const auto& edge : mesh::kTetrahedronEdges) {
        const Vector3d n = (x.col(edge[1]) - x.col(edge[0])).normalized();
        c += s * n(i) * n(j) * n(k) * n(l);
      }
      sum += c * c;
    }
    return sum;
  };
  const double s = spring_share(x);
  const double slope = (distance(s + 1e-4) - distance(s - 1e-4)) / 2e-4;
  EXPECT_NEAR(slope, 0, 1e-9);
  EXPECT_GT(distance(1.01 * s), distance(s));
}

// On the six-tetrahedra boxes of these meshes the network is a quarter too soft.
TEST(MassSpring, StretchedBarPullsWithThreeQuartersOfEAOverL) {
  for (auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const Body body = make_bar({0.2, 0.05, 0.05}, {8, 2, 2}, order, {1e5, 0.25, 300});
    MassSpringModel model(body);
    model.prepare();
    math::Pose X = body.grasps[0].X_OG_rest;
    X.translation().x() += 0.002;
    model.hold(0, X);
    for (int i = 0; i < 40; ++i) ASSERT_EQ(model.step(1).status, StepStatus::kConverged);
    const double expected = 1e5 * 0.05 * 0.05 / 0.2 * 0.002;
    EXPECT_GT(model.reaction(0).force.x(), 0.72 * expected);
    EXPECT_LT(model.reaction(0).force.x(), 0.80 * expected);
  }
}

TEST(MassSpring, EquilibriumOfForcesAndMoments) {
  Body body = free_bar(mesh::ElementOrder::kQuadratic);
  GraspRegion other;
  other.nodes = nodes_at(body.mesh, 0, 0);
  body.grasps.push_back(other);
  MassSpringModel model(body, exact());
  model.prepare();
  std::array<math::Pose, 2> X = {body.grasps[0].X_OG_rest, body.grasps[1].X_OG_rest};
  X[0].linear() = rotation(0.5, {1, 2, 0});
  X[0].translation() += Vector3d(-0.03, 0, 0.02);
  for (int g : {0, 1}) model.hold(g, X[g]);
  const Vector3d gravity(0, 1, -9.81);
  model.set_gravity(gravity);
  model.loads()(1, 7) = 0.1;
  for (int i = 0; i < 60; ++i) model.step(10);
  ASSERT_LT(model.velocities().cwiseAbs().maxCoeff(), 1e-12);
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
  EXPECT_LT(torque.norm(), 1e-8 * applied.norm());
}

TEST(MassSpring, FallsAsBackwardEulerDoesAndConvergesToTheParabola) {
  const auto fall = [](int steps) {
    const Body body = free_bar(mesh::ElementOrder::kQuadratic);
    MassSpringModel model(body, exact());
    model.prepare();
    model.set_gravity({0, 0, -9.81});
    const double h = 0.1 / steps;
    for (int i = 0; i < steps; ++i) model.step(h);
    const Matrix3Xd u = model.positions() - body.mesh.nodes;
    const double exactly = -9.81 * h * h * steps * (steps + 1) / 2;
    EXPECT_LT((u.row(2).array() - exactly).abs().maxCoeff(), 1e-9);
    EXPECT_LT(u.topRows<2>().cwiseAbs().maxCoeff(), 1e-9);
    return u.row(2).mean();
  };
  const double parabola = -9.81 * 0.1 * 0.1 / 2;
  const double coarse = fall(50) - parabola, fine = fall(100) - parabola;
  EXPECT_NEAR(fine / coarse, 0.5, 1e-3);
}

TEST(MassSpring, EnergyFallsAndMomentumStays) {
  const Body body = free_bar();
  MassSpringModel model(body, exact());
  model.prepare();
  const Matrix3Xd stretched = Vector3d(1.2, 0.9, 1).asDiagonal() * body.mesh.nodes;
  Matrix3Xd v = Matrix3Xd::Zero(3, stretched.cols());
  for (int i = 0; i < v.cols(); ++i) v.col(i) = Vector3d(0.3, 0.1 * std::sin(i), 0.2);
  ASSERT_TRUE(model.restore(stretched, v));
  const Vector3d momentum = v * model.masses();
  double energy = model.elastic_energy() + kinetic_energy(model);
  const double beginning = energy;
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(model.step(kMassSpringModelDt).status, StepStatus::kConverged);
    const double next = model.elastic_energy() + kinetic_energy(model);
    ASSERT_LE(next, energy * (1 + 1e-12)) << i;
    energy = next;
    const Vector3d now = model.velocities() * model.masses();
    ASSERT_LT((now - momentum).norm(), 1e-9 * momentum.norm());
  }
  EXPECT_LT(energy, 0.9 * beginning);
}

TEST(MassSpring, RigidRotationFeelsNoStiffnessDamping) {
  const auto spin_left = [](double factor) {
    Body body = free_bar();
    body.material.young_modulus = 1e6;
    body.damping.stiffness_factor = factor;
    MassSpringModel model(body, exact());
    model.prepare();
    Matrix3Xd v = body.mesh.nodes;
    const Vector3d centre = body.mesh.nodes * model.masses() / model.masses().sum();
    for (int i = 0; i < v.cols(); ++i) {
      v.col(i) = Vector3d(0, 0, 2).cross(Vector3d(body.mesh.nodes.col(i) - centre));
    }
    model.restore(body.mesh.nodes, v);
    const double begin = kinetic_energy(model);
    for (int i = 0; i < 200; ++i) model.step(kMassSpringModelDt);
    return kinetic_energy(model) / begin;
  };
  const double without = spin_left(0), with = spin_left(0.01);
  EXPECT_GT(without, 0.5);
  EXPECT_NEAR(with, without, 0.01 * without);
}

TEST(MassSpring, OptionsOutOfRangeAreRefused) {
  MassSpringOptions options;
  options.iterations = 0;
  EXPECT_THROW(MassSpringModel(free_bar(), options), std::invalid_argument);
  options = {};
  options.tolerance = 0;
  EXPECT_THROW(MassSpringModel(free_bar(), options), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::elasticity
