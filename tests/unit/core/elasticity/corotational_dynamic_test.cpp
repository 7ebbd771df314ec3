#include "core/elasticity/corotational_model.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/static_solver.hpp"
#include "core/math/polar.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// First bending frequency of a cantilever, (1.8751)^2 / (2 pi) sqrt(E I / rho A L^4), from the zero
// crossings of its free oscillation without damping.
TEST(CorotationalDynamic, CantileverOscillatesAtItsBendingFrequency) {
  const double L = 0.4, a = 0.03, E = 1e6, rho = 100;
  Body body = make_bar({L, a, a}, {10, 1, 1}, mesh::ElementOrder::kQuadratic, {E, 0, rho});
  body.damping = {0, 0};
  SolverOptions options;
  options.tolerance = 1e-8;
  CorotationalDynamic model(body, options);
  model.prepare();
  Matrix3Xd v = Matrix3Xd::Zero(3, body.mesh.node_count());
  for (int i = 0; i < v.cols(); ++i) v(2, i) = 0.05 * std::pow(body.mesh.nodes(0, i) / L, 2);
  ASSERT_TRUE(model.restore(body.mesh.nodes, v));
  std::vector<double> crossings;
  double last = 0;
  for (int i = 1; i <= 2000 && crossings.size() < 5; ++i) {
    model.step(kDt);
    refactor(model);
    const double z = face_displacement(body.mesh, L, model.positions()).z();
    if (last * z < 0) crossings.push_back((i - z / (z - last)) * kDt);
    last = z;
  }
  ASSERT_EQ(crossings.size(), 5u);
  const double frequency = 2 / (crossings[4] - crossings[0]);
  const double expected =
      1.8751 * 1.8751 / (2 * M_PI) * std::sqrt(E * a * a / 12 / (rho * std::pow(L, 4)));
  EXPECT_NEAR(frequency, expected, 0.02 * expected);
}

// In free fall with rotation nothing deforms beyond the centrifugal strain and the momentum is that
// of a rigid body: Rayleigh's stiffness part must not damp a rigid rotation.
TEST(CorotationalDynamic, FreeBodyFallsAndSpins) {
  Body body = make_bar({0.1, 0.05, 0.05}, {2, 1, 1}, mesh::ElementOrder::kQuadratic);
  body.fixed_nodes.clear();
  body.damping = {0, 0.01};
  body.gravity_O = Vector3d(0, 0, -9.81);
  SolverOptions options;
  options.tolerance = 1e-9;
  options.iterations = 20;
  CorotationalDynamic model(body, options);
  model.prepare();
  const Vector3d centre(0.05, 0.025, 0.025), spin(0, 0, 1);
  Matrix3Xd v(3, body.mesh.node_count());
  for (int i = 0; i < v.cols(); ++i) v.col(i) = spin.cross(body.mesh.nodes.col(i) - centre);
  ASSERT_TRUE(model.restore(body.mesh.nodes, v));
  const int steps = 200;
  for (int i = 0; i < steps; ++i) {
    model.step(kDt);
    refactor(model);
  }
  const Eigen::VectorXd mass = model.elements().nodal_mass();
  const Vector3d now = model.positions() * mass / mass.sum();
  // Backward Euler: sum of k h^2 g.
  const double fall = 9.81 * kDt * kDt * steps * (steps + 1) / 2;
  EXPECT_LT((now - centre - Vector3d(0, 0, -fall)).norm(), 1e-6);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < v.cols(); ++i) {
    covariance += (model.positions().col(i) - now) * (body.mesh.nodes.col(i) - centre).transpose();
  }
  const Vector3d turned = math::log_rotation(math::polar_rotation(covariance));
  EXPECT_LT((turned - spin * steps * kDt).norm(), 1e-3);
}

TEST(CorotationalDynamic, SettlesToTheStaticSolution) {
  const Body body = bar();
  const Matrix3Xd load = face_load(body.mesh, 0.2, Vector3d(0, 0, -0.1));
  const StaticSolution newton = solve_static(body, load);
  Body damped = body;
  damped.damping = {20, 0.01};
  CorotationalDynamic model(damped);
  model.prepare();
  model.loads() = load;
  for (int i = 0; i < 3000; ++i) {
    model.step(kDt);
    refactor(model);
  }
  EXPECT_LT((model.positions() - newton.positions).colwise().norm().maxCoeff(), 2e-5);
  EXPECT_LT(model.velocities().colwise().norm().maxCoeff(), 1e-4);
}

// A hundred thousand times stiffer than foam, where a plain quasi-Newton iteration diverges.
TEST(CorotationalDynamic, StiffBodyUnderALargeSwingStaysFinite) {
  Body body =
      make_bar({0.2, 0.05, 0.05}, {5, 1, 1}, mesh::ElementOrder::kQuadratic, {1e8, 0.35, 300});
  body.damping = {2, 0};
  CorotationalDynamic model(body);
  model.prepare();
  model.loads() = face_load(body.mesh, 0.2, Vector3d(0, 0, -1000));
  for (int i = 0; i < 300; ++i) {
    model.step(kDt);
    if (i % 10 == 0) refactor(model);
    ASSERT_TRUE(model.positions().allFinite());
  }
  EXPECT_LT((model.positions() - body.mesh.nodes).colwise().norm().maxCoeff(), 0.4);
}

// Every step against the converged one from the same state.
TEST(CorotationalDynamic, StepsEndWithinTheirAccuracyWithAndWithoutAnotherLook) {
  Body body = bar();
  body.fixed_nodes.clear();
  body.grasps[0].nodes = nodes_at(body.mesh, 0, 0);
  body.grasps[0].X_OG_rest.translation().x() = 0;
  SolverOptions exact;
  exact.tolerance = 1e-10;
  exact.accuracy = 0;
  exact.iterations = 60;
  for (const bool confirm : {true, false}) {
    SolverOptions options;
    options.accuracy = 2e-6;
    options.confirm = confirm;
    CorotationalDynamic model(body, options), reference(body, exact);
    math::Pose X = body.grasps[0].X_OG_rest;
    for (auto* m : {&model, &reference}) {
      m->prepare();
      m->hold(0, X);
      refactor(*m);
    }
    int corrections = 0;
    double error = 0;
    for (int i = 1; i <= 400; ++i) {
      const double t = i * kDt, start = std::min(1.0, t / 0.1);
      X.linear() = rotation(0.8 * start * std::sin(6 * t), {0, 0.6, 0.8});
      reference.release(0);
      ASSERT_TRUE(reference.restore(model.positions(), model.velocities()));
      for (auto* m : {&model, &reference}) {
        m->hold(0, X);
        m->loads() = face_load(body.mesh, 0.2, Vector3d(0, 0, -0.5 * start));
      }
      reference.step(kDt);
      corrections += model.step(kDt).iterations;
      if (i % 10 == 0) {
        refactor(model);
        refactor(reference);
      }
      error = std::max(error, (model.positions() - reference.positions()).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(error, options.accuracy) << confirm;
    EXPECT_LT(corrections, 600) << confirm;
  }
}

TEST(CorotationalDynamic, HeldHandFeelsTheWeightOfWhatItHolds) {
  Body body = bar();
  body.fixed_nodes.clear();
  body.gravity_O = Vector3d(0, 0, -9.81);
  body.damping = {50, 0.01};
  CorotationalDynamic model(body);
  model.prepare();
  model.hold(0, body.grasps[0].X_OG_rest);
  refactor(model);
  for (int i = 0; i < 3000; ++i) {
    model.step(kDt);
    refactor(model);
  }
  const double weight = 300 * 9.81 * 0.2 * 0.05 * 0.05;
  const math::Wrench reaction = model.reaction(0);
  EXPECT_NEAR(reaction.force.z(), weight, 1e-3 * weight);
  // About the held end the weight acts at half the length, minus the effect of the sag.
  EXPECT_NEAR(reaction.torque.y(), weight * 0.1, 0.1 * weight * 0.1);
}

}  // namespace
}  // namespace palpate::elasticity
