// Contact of the incremental models with rigid obstacles, against closed solutions and itself.
#include <gtest/gtest.h>

#include "core/mesh/grid_mesh.hpp"
#include "tests/unit/core/elasticity/obstacles.hpp"

namespace palpate::elasticity {
namespace {

using collision::Obstacle;
using Eigen::Vector3d;

class Orders : public ::testing::TestWithParam<mesh::ElementOrder> {};

/// Without lateral contraction a bar between its fixed end and a smooth wall is in uniaxial
/// compression: F = E A d / L.
TEST_P(Orders, ABarAgainstAWallIsInUniaxialCompression) {
  const double L = 0.2, d = 0.004;  // buckles at 0.01
  Body body = make_bar({L, 0.05, 0.05}, {6, 2, 2}, GetParam(), {1e5, 0, 300});
  body.grasps.clear();
  CorotationalQuasistatic model(body, with_obstacles({plane({L - d, 0, 0}, {-1, 0, 0}, 0)}));
  model.prepare();
  run_steps(model, 200);
  const StepReport report = model.step(kDt);
  EXPECT_EQ(report.status, StepStatus::kConverged);
  EXPECT_NEAR(contact_force(model).x(), -1e5 * 0.05 * 0.05 * d / L, 5e-5);
  EXPECT_LT(contact_force(model).tail<2>().norm(), 1e-6);
  EXPECT_LT(deepest(model), 2e-6);
  for (int n = 0; n < body.mesh.node_count(); ++n) {
    const Vector3d rest = body.mesh.nodes.col(n);
    EXPECT_LT((model.positions().col(n) - rest + Vector3d(rest.x() / L * d, 0, 0)).norm(), 2e-6);
  }
}

/// A bar sags onto a table: the answer does not depend on how often factors are computed.
TEST_P(Orders, TheEquilibriumDoesNotDependOnTheAgeOfTheFactor) {
  const auto settled = [&](int period) {
    Body body = make_bar({0.2, 0.03, 0.03}, {8, 2, 2}, GetParam(), {3e4, 0.3, 300});
    body.gravity_O = {0, 0, -kGravity};
    SolverOptions options = with_obstacles({plane({0, 0, -0.004}, {0, 0, 1}, 0.6)});
    options.tolerance = 1e-8;
    options.accuracy = 0;
    options.contact.tolerance = 1e-8;
    options.contact.sweeps = 200;
    auto model = std::make_unique<CorotationalQuasistatic>(body, options);
    model->prepare();
    run_steps(*model, 10, 1);
    const math::Pose rest = body.grasps[0].X_OG_rest;
    for (int i = 0; i <= 100; ++i) {
      math::Pose hand = rest;
      hand.translation() += i / 100.0 * Vector3d(-0.004, 0.003, -0.0035);
      model->hold(0, hand);
      model->step(kDt);
      if (i == 0) refactor(*model);
      if (i % period == 0) refactor(*model);
    }
    for (int i = 0; i < 300; ++i) {
      model->step(kDt);
      if (period < 1000) refactor(*model);
    }
    return model;
  };
  const auto fresh = settled(1), aged = settled(1000000);
  ASSERT_GT(contact_force(*fresh).z(), 0.1);
  const double travel = (fresh->positions() - fresh->body().mesh.nodes).colwise().norm().maxCoeff();
  const double difference = (fresh->positions() - aged->positions()).colwise().norm().maxCoeff();
  EXPECT_LT(difference, 5e-3 * travel) << "of " << travel;  // friction remembers the path
  for (const auto* model : {fresh.get(), aged.get()}) {
    EXPECT_LT(deepest(*model), 1e-6);
    for (const SurfaceContact& contact : model->contacts()) {
      const double r_n = contact.normal.dot(contact.force);
      EXPECT_GE(r_n, 0);
      EXPECT_LE((contact.force - r_n * contact.normal).norm(), 0.6 * r_n * (1 + 1e-5) + 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothElements, Orders,
                         ::testing::Values(mesh::ElementOrder::kLinear,
                                           mesh::ElementOrder::kQuadratic));

/// A cube on an incline: sticks below atan(mu), slides with g (sin - mu cos) above.
TEST(ObstacleContact, ABlockOnAnInclineSticksAndSlips) {
  const double mu = 0.5;
  for (const double steepness : {0.98, 1.02, 1.3}) {
    const double angle = std::atan(mu * steepness);
    Body body;
    body.mesh = mesh::make_element_mesh(mesh::make_box({0.05, 0.05, 0.05}, {2, 2, 2}),
                                        mesh::ElementOrder::kQuadratic);
    body.material = {1e5, 0.3, 300};
    body.damping = {0, 0.002};
    body.gravity_O = kGravity * Vector3d(std::sin(angle), 0, -std::cos(angle));
    SolverOptions options = with_obstacles({plane(Vector3d::Zero(), {0, 0, 1}, mu)});
    options.iterations = 6;
    CorotationalDynamic model(body, options);
    model.prepare();
    run_steps(model, 300);  // the shock of the sudden weight dies down
    const Vector3d from = model.positions().rowwise().mean();
    const double v_from = model.velocities().row(0).mean();
    const int steps = 300;
    run_steps(model, steps);
    const double t = steps * kDt;
    const double travel = model.positions().row(0).mean() - from.x();
    if (steepness < 1) {
      EXPECT_NEAR(travel, 0, 2e-5);
    } else {
      const double a = kGravity * (std::sin(angle) - mu * std::cos(angle));
      EXPECT_NEAR((model.velocities().row(0).mean() - v_from) / t, a, 0.02 * kGravity * mu);
      EXPECT_NEAR(travel - v_from * t, 0.5 * a * t * t, 0.02 * kGravity * mu * 0.5 * t * t);
      EXPECT_GT(travel, 1e-3);
    }
    const Vector3d weight = 300 * 1.25e-4 * body.gravity_O;
    EXPECT_NEAR(contact_force(model).z(), -weight.z(), 2e-2 * weight.norm());
    EXPECT_LT(deepest(model), 2e-3 * 0.05);
  }
}

/// Mirrored worlds give mirrored answers.
TEST(ObstacleContact, MirroredWorldsAreMirrored) {
  const auto pressed = [](double side) {
    // the five-tetrahedra cut is symmetric about the middle of an even number of cells
    Body body;
    body.mesh = mesh::make_element_mesh(
        mesh::make_grid(mesh::even_planes({0, -0.02, 0}, {0.16, 0.04, 0.02}, {8, 2, 1}),
                        mesh::CellCut::kFive),
        mesh::ElementOrder::kQuadratic);
    body.material = {5e4, 0.3, 100};
    body.fixed_nodes = nodes_at(body.mesh, 0, 0);
    body.gravity_O = {0, 0, -kGravity};
    const Obstacle rod{
        "rod", collision::Cylinder{0.02, 0.1},
        math::make_pose(rotation(M_PI / 2 - side * 0.4, {1, 0, 0}), {0.11, side * 0.004, -0.023}),
        0.3};
    SolverOptions options = with_obstacles({rod});
    options.contact.sweeps = 100;
    auto model = std::make_unique<CorotationalQuasistatic>(body, options);
    model->prepare();
    run_steps(*model, 400);
    return model;
  };
  const auto left = pressed(1), right = pressed(-1);
  const Vector3d force = contact_force(*left);
  ASSERT_GT(force.z(), 1e-3);
  const Eigen::DiagonalMatrix<double, 3> mirror(1, -1, 1);
  EXPECT_LT((mirror * contact_force(*right) - force).norm(), 2e-3 * force.norm());
  const Eigen::Matrix3Xd& nodes = left->body().mesh.nodes;
  for (int n = 0; n < nodes.cols(); ++n) {
    for (int m = 0; m < nodes.cols(); ++m) {
      if ((mirror * nodes.col(m) - nodes.col(n)).norm() > 1e-9) continue;
      EXPECT_LT((mirror * right->positions().col(m) - left->positions().col(n)).norm(), 1e-5);
    }
  }
}

/// What has left an obstacle is as if it had never touched it.
TEST(ObstacleContact, AfterContactTheObjectIsAsBefore) {
  Body body =
      make_bar({0.2, 0.03, 0.03}, {8, 2, 2}, mesh::ElementOrder::kQuadratic, {3e4, 0.3, 30});
  CorotationalQuasistatic touching(body, with_obstacles({rod({0.1, 0.015, -0.022}, 0.02, 0.5)}));
  CorotationalQuasistatic free(body);
  const math::Pose rest = body.grasps[0].X_OG_rest;
  double most = 0;
  for (CorotationalModel* model :
       {static_cast<CorotationalModel*>(&touching), static_cast<CorotationalModel*>(&free)}) {
    model->prepare();
    for (int i = 0; i <= 400; ++i) {
      math::Pose hand = rest;
      hand.translation().z() -= 0.02 * std::sin(M_PI * i / 400.0);
      model->hold(0, hand);
      model->step(kDt);
      if (i % 20 == 0) refactor(*model);
      most = std::max(most, contact_force(*model).z());
      EXPECT_LT(deepest(*model), 2e-3 * 0.03) << i;
    }
    run_steps(*model, 20, 1);
  }
  EXPECT_GT(most, 0.05);
  EXPECT_EQ(contact_force(touching).norm(), 0);
  EXPECT_LT((touching.positions() - free.positions()).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace palpate::elasticity
