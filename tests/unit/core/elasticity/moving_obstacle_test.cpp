// Contact with obstacles that move, against closed solutions.
#include <gtest/gtest.h>

#include "core/mesh/grid_mesh.hpp"
#include "tests/unit/core/elasticity/obstacles.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;

collision::Placement at(const math::Pose& X_OB, const Vector3d& velocity = Vector3d::Zero()) {
  collision::Placement placement;
  placement.X_OB = X_OB;
  placement.V_O_B.linear = velocity;
  return placement;
}

/// A cube fixed at its upper side, on a plane that presses it by `depth`.
std::unique_ptr<CorotationalQuasistatic> pressed_cube(double depth, double friction) {
  Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box({0.05, 0.05, 0.05}, {2, 2, 2}),
                                      mesh::ElementOrder::kQuadratic);
  body.material = {1e5, 0, 300};
  body.fixed_nodes = nodes_at(body.mesh, 2, 0.05);
  SolverOptions options = with_obstacles({plane({0.025, 0.025, -0.001}, {0, 0, 1}, friction)});
  options.contact.sweeps = 200;
  options.contact.tolerance = 1e-8;
  options.tolerance = 1e-8;
  options.accuracy = 0;
  options.iterations = 20;
  auto model = std::make_unique<CorotationalQuasistatic>(body, options);
  model->prepare();
  run_steps(*model, 5, 1);
  EXPECT_EQ(contact_force(*model).norm(), 0);
  for (int i = 0; i <= 50; ++i) {
    math::Pose X = math::Pose::Identity();
    X.translation() << 0.025, 0.025, -0.001 + (0.001 + depth) * i / 50;
    model->place_obstacle(0, at(X));
    run_steps(*model, 1);
  }
  run_steps(*model, 20, 5);
  return model;
}

math::Pose pressing(double depth) {
  math::Pose X = math::Pose::Identity();
  X.translation() << 0.025, 0.025, depth;
  return X;
}

/// Without lateral contraction: F = E A d / L.
TEST(MovingObstacle, ARisingPlaneCompressesACube) {
  for (const double depth : {0.0005, 0.001}) {
    const auto model = pressed_cube(depth, 0);
    EXPECT_NEAR(contact_force(*model).z(), 1e5 * 0.05 * depth, 2e-4);
    EXPECT_LT(deepest(*model), 1e-6);
  }
}

/// Slides and turns the plane under a pressed cube; returns the largest motion of a lower node
/// relative to the plane, m. Every step must converge.
double motion_on_plane(CorotationalQuasistatic& model, double depth) {
  const Eigen::Matrix3Xd before = model.positions();
  math::Pose X = pressing(depth);
  for (int i = 1; i <= 50; ++i) {
    X = pressing(depth);
    X.translation() += i / 50.0 * Vector3d(3e-4, -2e-4, 0);
    X.linear() = rotation(0.01 * i / 50, Vector3d::UnitZ());
    model.place_obstacle(0, at(X));
    EXPECT_EQ(model.step(kDt).status, StepStatus::kConverged) << i;
    refactor(model);
  }
  run_steps(model, 40, 5);
  const math::Pose moved = X * pressing(depth).inverse();
  double largest = 0;
  for (const int node : nodes_at(model.body().mesh, 2, 0))
    largest = std::max(largest, (model.positions().col(node) - moved * before.col(node)).norm());
  return largest;
}

TEST(MovingObstacle, WhatSticksFollowsAPlaneThatSlidesAndTurns) {
  EXPECT_LT(motion_on_plane(*pressed_cube(1e-3, 3), 1e-3), 1e-6);
}

/// Then forces are not unique, and a point may open and stick again while others hold its surface.
TEST(MovingObstacle, MuchFrictionConvergesAndHolds) {
  for (const double friction : {10, 50})
    EXPECT_LT(motion_on_plane(*pressed_cube(1e-3, friction), 1e-3), 5e-5) << friction;
}

/// In gross sliding the friction force is the coefficient times the normal force, along the motion
/// of the plane.
TEST(MovingObstacle, APlaneThatSlidesDragsWithTheLimitOfFriction) {
  const double depth = 1e-3, mu = 0.3;
  const auto model = pressed_cube(depth, mu);
  math::Pose X = pressing(depth);
  const Vector3d way = Vector3d(0.6, 0.8, 0);
  const auto slide = [&](const Vector3d& direction) {
    for (int i = 0; i < 200; ++i) {
      X.translation() += 1e-4 * direction;
      model->place_obstacle(0, at(X, 0.1 * direction));
      run_steps(*model, 1);
    }
    const Vector3d force = contact_force(*model);
    EXPECT_GT(force.z(), 1);
    EXPECT_NEAR(force.head<2>().norm(), mu * force.z(), 1e-3 * mu * force.z());
    EXPECT_GT(force.dot(direction), 0.999 * mu * force.z());
    for (const SurfaceContact& contact : model->contacts()) {
      if (contact.presses()) {
        EXPECT_TRUE(contact.slips);
      }
    }
  };
  slide(way);
  slide(-way);
  const double force = contact_force(*model).z();
  run_steps(*model, 20, 5);  // the plane rests: so does the cube, under the same load
  EXPECT_NEAR(contact_force(*model).z(), force, 1e-3 * force);
}

/// A cube set on a conveyor at speed v slides for v / (mu g) with acceleration mu g, and then moves
/// with it.
TEST(MovingObstacle, AConveyorTakesACubeAlong) {
  const double mu = 0.4, v = 0.4;
  Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box({0.05, 0.05, 0.02}, {2, 2, 1}),
                                      mesh::ElementOrder::kQuadratic);
  body.material = {2e5, 0.3, 300};
  body.damping = {0, 0.002};
  body.gravity_O = {0, 0, -kGravity};
  SolverOptions options = with_obstacles({plane(Vector3d::Zero(), {0, 0, 1}, mu)});
  options.iterations = 6;
  CorotationalDynamic model(body, options);
  model.prepare();
  run_steps(model, 300);  // the shock of the sudden weight dies down
  const auto speed = [&] { return model.velocities().row(0).mean(); };
  ASSERT_NEAR(speed(), 0, 1e-3);
  math::Pose X = math::Pose::Identity();
  double time = 0;
  for (int i = 1; i <= 250; ++i) {
    time += kDt;
    X.translation().x() += v * kDt;
    model.place_obstacle(0, at(X, {v, 0, 0}));
    ASSERT_NE(model.step(kDt).status, StepStatus::kFailed);
    if (i % 20 == 0) refactor(model);
    if (i % 25 == 0) {
      EXPECT_NEAR(speed(), std::min(v, mu * kGravity * time), 0.03 * v) << time;
    }
  }
  EXPECT_NEAR(speed(), v, 0.005 * v);
  EXPECT_LT(deepest(model), 2e-3 * 0.02);
}

TEST(MovingObstacle, OneThatIsNotPlacedTouchesNothing) {
  const auto model = pressed_cube(1e-3, 0.5);
  ASSERT_GT(contact_force(*model).z(), 1);
  collision::Placement nowhere = at(pressing(1e-3));
  nowhere.is_known = false;
  model->place_obstacle(0, nowhere);
  run_steps(*model, 30, 5);
  EXPECT_EQ(contact_force(*model).norm(), 0);
  EXPECT_LT((model->positions() - model->body().mesh.nodes).norm(), 1e-6);
}

}  // namespace
}  // namespace palpate::elasticity
