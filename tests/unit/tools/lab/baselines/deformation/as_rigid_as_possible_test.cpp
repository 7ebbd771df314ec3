#include "tools/lab/baselines/deformation/as_rigid_as_possible.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/static_solver.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::elasticity {
namespace {

using baselines::AsRigidAsPossible;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kDt = 1e-3;  // s

class AsRigidAsPossibleTest : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  Body bar(const Material& material = {30e3, 0.3, 26}) const {
    const bool linear = GetParam() == mesh::ElementOrder::kLinear;
    const int across = linear ? 2 : 1;
    return make_bar({0.5, 0.06, 0.06}, {linear ? 16 : 8, across, across}, GetParam(), material);
  }
  static math::Pose bent(const Body& body) {
    math::Pose X_OG = body.grasps[0].X_OG_rest;
    X_OG.translation() += Vector3d(-0.05, 0.05, 0.12);
    X_OG.linear() = rotation(0.6, {0.5, -1, 0.3});
    return X_OG;
  }
  /// Iterates to convergence. Returns the number of iterations, 0 if there were too many.
  static int settle(AsRigidAsPossible& model) {
    for (int i = 1; i <= 5000; ++i) {
      if (model.step(kDt).status == StepStatus::kConverged) return i;
    }
    return 0;
  }
  static double distance(const Matrix3Xd& a, const Matrix3Xd& b) {
    return (a - b).colwise().norm().maxCoeff();
  }
};

TEST_P(AsRigidAsPossibleTest, FollowsARigidMotionExactly) {
  Body body = bar();
  body.fixed_nodes.clear();
  AsRigidAsPossible model(body, {2, 1e-12});
  model.prepare();
  math::Pose motion = math::Pose::Identity();
  motion.linear() = rotation(1.2, {1, -2, 0.5});
  motion.translation() = Vector3d(0.3, -1, 2);
  model.hold(0, motion * body.grasps[0].X_OG_rest);
  ASSERT_GT(settle(model), 0);
  EXPECT_LT(distance(model.positions(), motion * body.mesh.nodes), 1e-9);
  EXPECT_LT(model.energy(), 1e-18);
}

TEST_P(AsRigidAsPossibleTest, EnergyNeverRises) {
  const Body body = bar();
  AsRigidAsPossible model(body, {1, 0});
  model.prepare();
  model.hold(0, bent(body));
  model.step(kDt);
  double last = model.energy();
  const double first = last;
  for (int i = 0; i < 400; ++i) {
    model.step(kDt);
    const double now = model.energy();
    ASSERT_LE(now, last * (1 + 1e-12)) << i;
    last = now;
  }
  EXPECT_LT(last, 0.5 * first);
}

TEST_P(AsRigidAsPossibleTest, AnswersIndependentlyOfItsOrientationAndOfTheMaterial) {
  const Body body = bar();
  Body turned = bar({3e6, 0.1, 900});
  math::Pose X = math::Pose::Identity();
  X.linear() = rotation(2, {1, 1, -3});
  X.translation() = Vector3d(1, 2, -1);
  turned.mesh.nodes = X * body.mesh.nodes;
  turned.grasps[0].X_OG_rest = X * body.grasps[0].X_OG_rest;
  turned.gravity_O << 0, 0, -9.81;
  AsRigidAsPossible model(body), other(turned);
  model.prepare();
  other.prepare();
  other.loads().setConstant(0.1);
  for (int i = 1; i <= 100; ++i) {
    math::Pose X_OG = body.grasps[0].X_OG_rest;
    X_OG.translation() += Vector3d(-3e-4, 4e-4, 1e-3) * i;
    X_OG.linear() = rotation(0.005 * i, {1, -2, 1});
    model.hold(0, X_OG);
    other.hold(0, X * X_OG);
    model.step(kDt);
    other.step(kDt);
  }
  EXPECT_LT(distance(X * model.positions(), other.positions()), 1e-9);
  EXPECT_EQ(model.reaction(0).force.norm(), 0);
}

TEST_P(AsRigidAsPossibleTest, BendsABarAlmostAsElasticityDoes) {
  Body body = bar({30e3, 0, 26});
  AsRigidAsPossible model(body);
  model.prepare();
  model.hold(0, bent(body));
  const int ticks = settle(model);
  ASSERT_GT(ticks, 0);
  const StaticSolution elastic =
      solve_static(body, Matrix3Xd::Zero(3, body.mesh.node_count()), {bent(body), std::nullopt});
  ASSERT_TRUE(elastic.converged);
  const double error = distance(model.positions(), elastic.positions);
  const double moved = distance(body.mesh.nodes, elastic.positions);
  std::printf("%.1f mm off of %.0f mm at the worst node, after %d ticks\n", 1e3 * error,
              1e3 * moved, ticks);
  EXPECT_LT(error, 0.1 * moved);
}

TEST_P(AsRigidAsPossibleTest, FollowsAHandWithoutLaggingBehind) {
  const Body body = bar();
  AsRigidAsPossible model(body), still(body);
  model.prepare();
  still.prepare();
  math::Pose X_OG = body.grasps[0].X_OG_rest;
  for (int i = 1; i <= 500; ++i) {  // 0.2 m/s
    X_OG.translation() += Vector3d(-2e-5, 0, 2e-4);
    model.hold(0, X_OG);
    model.step(kDt);
  }
  still.hold(0, X_OG);
  ASSERT_GT(settle(still), 0);
  const double lag = distance(model.positions(), still.positions());
  std::printf("lag %.2f mm\n", 1e3 * lag);
  EXPECT_LT(lag, 5e-3);
}

TEST_P(AsRigidAsPossibleTest, GraspsAreMadeAndReleasedAtOnce) {
  Body body = bar();
  GraspRegion other;
  other.nodes = body.fixed_nodes;
  body.fixed_nodes.clear();
  body.grasps.push_back(other);
  AsRigidAsPossible model(body, {4, 1e-8});
  model.prepare();
  EXPECT_EQ(model.step(kDt).status, StepStatus::kConverged) << "nothing holds it";
  EXPECT_EQ(model.positions(), body.mesh.nodes);
  math::Pose X = other.X_OG_rest;
  X.translation().z() = 0.01;
  model.hold(1, X);
  ASSERT_GT(settle(model), 0);
  EXPECT_LT(distance(model.positions(), body.mesh.nodes.colwise() + Vector3d(0, 0, 0.01)), 1e-4);
  model.hold(0, body.grasps[0].X_OG_rest);
  ASSERT_GT(settle(model), 0);
  for (int node : body.grasps[0].nodes)
    EXPECT_LT((model.positions().col(node) - body.mesh.nodes.col(node)).norm(), 1e-12);
  model.release(1);
  ASSERT_GT(settle(model), 0);
  EXPECT_LT(distance(model.positions(), body.mesh.nodes), 1e-4);
}

TEST_P(AsRigidAsPossibleTest, ResetAndRestoreDoWhatTheySay) {
  const Body body = bar();
  AsRigidAsPossible model(body);
  model.prepare();
  const auto run = [&] {
    model.hold(0, bent(body));
    for (int i = 0; i < 30; ++i) model.step(kDt);
    return model.positions();
  };
  const Matrix3Xd first = run();
  model.reset();
  EXPECT_EQ(model.positions(), body.mesh.nodes);
  EXPECT_EQ(run(), first);
  AsRigidAsPossible next(body);
  next.prepare();
  ASSERT_TRUE(next.restore(first, model.velocities()));
  next.hold(0, bent(body));
  next.step(kDt);
  EXPECT_LT(distance(next.positions(), first), 5e-3) << "no jump";
}

TEST_P(AsRigidAsPossibleTest, TakesNoMoreIterationsThanItMay) {
  const Body body = bar();
  AsRigidAsPossible model(body, {4, 0});
  model.prepare();
  model.hold(0, bent(body));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(model.step(kDt).iterations, 4);
}

TEST_P(AsRigidAsPossibleTest, WhatIsNotFiniteOrOutOfRangeIsRefused) {
  const Body body = bar();
  EXPECT_THROW(AsRigidAsPossible(body, {0, 1e-6}), std::invalid_argument);
  EXPECT_THROW(AsRigidAsPossible(body, {1, std::nan("")}), std::invalid_argument);
  AsRigidAsPossible model(body);
  model.prepare();
  math::Pose X_OG = body.grasps[0].X_OG_rest;
  X_OG.translation().x() = std::nan("");
  model.hold(0, X_OG);
  EXPECT_EQ(model.step(kDt).status, StepStatus::kFailed);
  EXPECT_EQ(model.positions(), body.mesh.nodes);
  for (const double far : {1e150, 1e300}) {
    X_OG.translation().x() = far;
    model.hold(0, X_OG);
    for (int i = 0; i < 3; ++i) model.step(kDt);
    EXPECT_TRUE(model.positions().allFinite());
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, AsRigidAsPossibleTest,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic),
                         [](const auto& of) {
                           return of.param == mesh::ElementOrder::kLinear ? "linear" : "quadratic";
                         });

}  // namespace
}  // namespace palpate::elasticity
