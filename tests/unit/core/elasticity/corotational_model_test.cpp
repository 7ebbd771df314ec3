#include "core/elasticity/corotational_model.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "core/elasticity/static_solver.hpp"
#include "core/math/polar.hpp"
#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

math::Pose moved_grasp(const Body& body) {
  math::Pose X = body.grasps[0].X_OG_rest;
  X.translation() += Vector3d(-0.005, 0.006, -0.01);
  X.linear() = rotation(0.4, {0.6, 0.8, 0});
  return X;
}

class ModelsOfEveryOrder : public testing::TestWithParam<mesh::ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Order, ModelsOfEveryOrder,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST_P(ModelsOfEveryOrder, FixedPointOfAStaleFactorIsTheNewtonSolution) {
  const Body body = bar(GetParam());
  const Matrix3Xd load = face_load(body.mesh, 0.2, Vector3d(0, 0.05, -0.2));
  const StaticSolution newton = solve_static(body, load);
  ASSERT_TRUE(newton.converged);
  SolverOptions options;
  options.tolerance = 1e-9;
  options.accuracy = 0;
  for (bool with_refactorisation : {false, true}) {
    CorotationalQuasistatic model(body, options);
    model.prepare();
    model.loads() = load;
    EXPECT_EQ(settle(model, with_refactorisation).status, StepStatus::kConverged);
    EXPECT_LT((model.positions() - newton.positions).colwise().norm().maxCoeff(), 1e-7);
  }
}

TEST_P(ModelsOfEveryOrder, HeldGraspMovesTheBodyAndReactsAsNewtonSays) {
  const Body body = bar(GetParam());
  const math::Pose X = moved_grasp(body);
  const Matrix3Xd none = Matrix3Xd::Zero(3, body.mesh.node_count());
  const StaticSolution newton = solve_static(body, none, {X, {}});
  ASSERT_TRUE(newton.converged);
  const math::Wrench expected = patch_wrench(body.grasps[0], X, newton.positions, newton.reactions);

  SolverOptions options;
  options.tolerance = 1e-9;
  options.accuracy = 0;
  CorotationalQuasistatic model(body, options);
  model.prepare();
  model.hold(0, X);
  EXPECT_NE(model.step(kDt).status, StepStatus::kFailed) << "the old factor serves the new set";
  EXPECT_EQ(settle(model, true).status, StepStatus::kConverged);
  EXPECT_LT((model.positions() - newton.positions).colwise().norm().maxCoeff(), 1e-7);
  const math::Wrench reaction = model.reaction(0);
  EXPECT_LT((reaction.force - expected.force).norm(), 1e-6 * expected.force.norm());
  EXPECT_LT((reaction.torque - expected.torque).norm(), 1e-6 * expected.torque.norm());

  model.release(0);
  EXPECT_NE(model.step(kDt).status, StepStatus::kFailed);
  EXPECT_EQ(settle(model, true).status, StepStatus::kConverged);
  EXPECT_LT((model.positions() - body.mesh.nodes).colwise().norm().maxCoeff(), 1e-6)
      << "let go, the bar springs back";
  EXPECT_EQ(model.reaction(0).force.norm(), 0);
}

TEST(CorotationalQuasistatic, FollowsAMovingHandWithinTwoIterations) {
  const Body body = bar();
  SolverOptions options;
  options.tolerance = 1e-5;
  CorotationalQuasistatic model(body, options);
  model.prepare();
  math::Pose X = body.grasps[0].X_OG_rest;
  model.hold(0, X);
  refactor(model);
  int not_converged = 0;
  for (int i = 0; i < 1000; ++i) {
    const double t = i * kDt;
    X.translation() =
        body.grasps[0].X_OG_rest.translation() +
        Vector3d(-0.01 * (1 - std::cos(t)), 0.02 * std::sin(3 * t), 0.03 * std::sin(t));
    X.linear() = rotation(0.4 * std::sin(2 * t), {0.6, 0.8, 0});
    model.hold(0, X);
    not_converged += model.step(kDt).status != StepStatus::kConverged;
    // The background worker needs a few ticks for a factorisation.
    if (i % 20 == 0) refactor(model);
  }
  EXPECT_LT(not_converged, 20);
  const StaticSolution newton = solve_static(body, Matrix3Xd::Zero(3, body.mesh.node_count()),
                                             {X, {}}, {}, &model.positions());
  ASSERT_TRUE(newton.converged);
  EXPECT_LT((model.positions() - newton.positions).colwise().norm().maxCoeff(), 2e-5);
}

TEST(CorotationalQuasistatic, SagsUnderGravityAsTheoryAndNewtonSay) {
  Body body = make_bar({0.3, 0.05, 0.05}, {8, 1, 1}, mesh::ElementOrder::kQuadratic, {2e5, 0, 50});
  body.gravity_O = Vector3d(0, 0, -9.81);
  CorotationalQuasistatic model(body);
  model.prepare();
  ASSERT_EQ(settle(model, true).status, StepStatus::kConverged);
  // Timoshenko: w L^4 / 8 E I + w L^2 / 2 k G A.
  const double w = 50 * 9.81 * 0.05 * 0.05, inertia = std::pow(0.05, 4) / 12;
  const double shear = 2e5 / 2 * 0.05 * 0.05 * 5 / 6;
  const double expected = w * std::pow(0.3, 4) / (8 * 2e5 * inertia) + w * 0.3 * 0.3 / (2 * shear);
  EXPECT_NEAR(-face_displacement(body.mesh, 0.3, model.positions()).z(), expected, 0.02 * expected);
  model.set_gravity(Vector3d::Zero());
  ASSERT_EQ(settle(model, true).status, StepStatus::kConverged);
  EXPECT_LT((model.positions() - body.mesh.nodes).colwise().norm().maxCoeff(), 1e-5);
}

TEST(CorotationalQuasistatic, RefactorisationRunsInAThreadBesidesTheLoop) {
  const Body body = bar();
  CorotationalQuasistatic model(body), reference(body);
  for (auto* m : {&model, &reference}) {
    m->prepare();
    m->loads() = face_load(body.mesh, 0.2, Vector3d(0, 0, -0.3));
  }
  settle(reference, true);
  model.step(kDt);
  int installed = 0;
  for (int i = 0; i < 30; ++i) {
    Refactorisation* job = model.wanted_refactorisation();
    if (!job) {
      model.step(kDt);
      continue;
    }
    EXPECT_EQ(model.wanted_refactorisation(), nullptr) << "one at a time";
    std::thread worker([job] { job->run(); });
    for (int k = 0; k < 5; ++k) model.step(kDt);
    worker.join();
    model.install(*job);
    ++installed;
  }
  EXPECT_GT(installed, 0);
  EXPECT_EQ(settle(model, false).status, StepStatus::kConverged);
  EXPECT_LT((model.positions() - reference.positions()).colwise().norm().maxCoeff(), 1e-5);
  EXPECT_GE(model.sensitivity().age, kDt);
}

TEST(CorotationalQuasistatic, OneFactorServesGraspsMadeAndReleased) {
  const Body body = bar();
  CorotationalQuasistatic model(body);
  model.prepare();
  math::Pose X = body.grasps[0].X_OG_rest;
  model.hold(0, X);
  Refactorisation* job = model.wanted_refactorisation();
  ASSERT_NE(job, nullptr);
  job->run();
  model.release(0);
  model.install(*job);
  EXPECT_FALSE(model.sensitivity().valid) << "it was of the held grasp";
  EXPECT_EQ(model.step(kDt).status, StepStatus::kConverged);
  X.translation().z() += 1e-3;
  model.hold(0, X);
  for (int i = 0; i < 10; ++i) model.step(kDt);
  const StaticSolution newton =
      solve_static(body, Matrix3Xd::Zero(3, body.mesh.node_count()), {X, {}});
  EXPECT_LT((model.positions() - newton.positions).colwise().norm().maxCoeff(), 1e-6);
}

TEST(CorotationalQuasistatic, WithoutSupportTheMatrixIsShiftedAndSaysSo) {
  Body body = bar();
  body.fixed_nodes.clear();
  CorotationalQuasistatic model(body);
  model.prepare();
  EXPECT_TRUE(model.is_regularised());
  EXPECT_FALSE(model.sensitivity().valid);
  EXPECT_EQ(model.step(kDt).status, StepStatus::kConverged);
  // Balanced loads have a solution: pulled at both ends the body elongates by about F L / E A.
  model.loads() = face_load(body.mesh, 0.2, Vector3d(0.5, 0, 0)) +
                  face_load(body.mesh, 0.0, Vector3d(-0.5, 0, 0));
  EXPECT_EQ(settle(model, true, 2000).status, StepStatus::kConverged);
  const double longer = face_displacement(body.mesh, 0.2, model.positions()).x() -
                        face_displacement(body.mesh, 0.0, model.positions()).x();
  EXPECT_NEAR(longer, 0.5 * 0.2 / (1e5 * 0.05 * 0.05), 0.02 * longer);
  model.hold(0, body.grasps[0].X_OG_rest);
  refactor(model);
  EXPECT_FALSE(model.is_regularised());
  EXPECT_TRUE(model.sensitivity().valid);
}

TEST(CorotationalQuasistatic, AnUnsupportedBodyIsReleasedOnceAFactorServesIt) {
  Body body = bar();
  body.fixed_nodes.clear();
  CorotationalQuasistatic model(body);
  model.prepare();
  model.hold(0, moved_grasp(body));
  settle(model, true);
  ASSERT_FALSE(model.is_regularised());
  const Matrix3Xd held = model.positions();

  model.release(0);
  for (int i = 0; i < 5; ++i) {
    model.release(0);  // repeated, as by an estimator, it changes nothing
    EXPECT_EQ(model.step(kDt).status, StepStatus::kConverged) << i;
    EXPECT_TRUE(model.is_held(0));
    EXPECT_LT((model.positions() - held).colwise().norm().maxCoeff(), 1e-5);
  }
  refactor(model);
  EXPECT_FALSE(model.is_held(0));
  EXPECT_TRUE(model.is_regularised());
  EXPECT_EQ(model.reaction(0).force.norm(), 0);
  EXPECT_NE(model.step(kDt).status, StepStatus::kFailed);

  model.hold(0, moved_grasp(body));
  refactor(model);
  model.release(0);
  model.hold(0, moved_grasp(body));  // taken back
  refactor(model);
  EXPECT_TRUE(model.is_held(0));
}

TEST(CorotationalQuasistatic, RestoreRefusesWhatDoesNotFit) {
  const Body body = bar();
  CorotationalQuasistatic model(body);
  model.prepare();
  Matrix3Xd x = body.mesh.nodes, v = Matrix3Xd::Zero(3, x.cols());
  EXPECT_FALSE(model.restore(x.leftCols(3), v.leftCols(3)));
  x(0, 1) = std::nan("");
  EXPECT_FALSE(model.restore(x, v));
  EXPECT_EQ(model.positions(), body.mesh.nodes);
}

TEST(CorotationalQuasistatic, ARestoredShapeIsUntangledWhateverBecameOfTheOneBefore) {
  const Body body = bar();
  CorotationalQuasistatic model(body);
  model.prepare();
  const Matrix3Xd still = Matrix3Xd::Zero(3, body.mesh.node_count());
  std::srand(1);
  const auto tangled = [&] {
    return Matrix3Xd(body.mesh.nodes + 0.4 * Matrix3Xd::Random(3, body.mesh.node_count()));
  };
  for (int steps = 1; steps <= 20; ++steps) {
    ASSERT_TRUE(model.restore(tangled(), still));
    settle(model, true, steps);
    ASSERT_TRUE(model.restore(tangled(), still));
    settle(model, true, 500);
    EXPECT_LT((model.positions() - body.mesh.nodes).colwise().norm().maxCoeff(), 1e-3) << steps;
  }
}

template <class Model>
void expect_nan_does_no_harm() {
  const Body body = bar();
  Model model(body);
  model.prepare();
  model.loads() = face_load(body.mesh, 0.2, Vector3d(0, 0, -0.1));
  for (int i = 0; i < 20; ++i) model.step(kDt);
  const Matrix3Xd x = model.positions(), v = model.velocities();
  model.loads()(1, 7) = std::nan("");
  EXPECT_EQ(model.step(kDt).status, StepStatus::kFailed);
  model.loads()(1, 7) = 1e300;  // finite, but nothing else is guaranteed
  EXPECT_NE(model.step(kDt).status, StepStatus::kConverged);
  EXPECT_TRUE(model.positions().allFinite());
  model.restore(x, v);
  model.loads()(1, 7) = 0;
  EXPECT_EQ(model.positions(), x);
  EXPECT_EQ(model.velocities(), v);
  EXPECT_EQ(model.step(std::nan("")).status, StepStatus::kFailed);
  EXPECT_NE(model.step(kDt).status, StepStatus::kFailed);
  EXPECT_LT((model.positions() - x).colwise().norm().maxCoeff(), 1e-3);

  model.hold(0, body.grasps[0].X_OG_rest);
  refactor(model);
  model.step(kDt);
  const Matrix3Xd held = model.positions();
  math::Pose X = body.grasps[0].X_OG_rest;
  X.translation().x() = std::nan("");
  model.hold(0, X);
  EXPECT_EQ(model.step(kDt).status, StepStatus::kFailed);
  EXPECT_EQ(model.positions(), held);
}

TEST(Robustness, NanLeavesTheLastGoodState) {
  expect_nan_does_no_harm<CorotationalQuasistatic>();
  expect_nan_does_no_harm<CorotationalDynamic>();
}

TEST_P(ModelsOfEveryOrder, MirroredAndRandomStartsReturnToRest) {
  const Body body = make_bar({0.2, 0.05, 0.05}, {6, 2, 2}, GetParam());
  const Matrix3Xd rest = body.mesh.nodes, none = Matrix3Xd::Zero(3, rest.cols());
  std::srand(11);
  for (bool mirrored : {true, false}) {
    Matrix3Xd x = rest;
    for (int i = 0; i < x.cols(); ++i) {
      if (mirrored) {
        x(0, i) = -x(0, i);
      } else {
        x.col(i) = 0.1 * Vector3d::Random();
      }
    }
    CorotationalQuasistatic model(body);
    model.prepare();
    ASSERT_TRUE(model.restore(x, none));
    // Long enough in equilibrium for inverted elements to be detected.
    int at_rest = 0;
    for (int i = 0; i < 5000 && at_rest < 300; ++i) {
      const StepReport report = model.step(kDt);
      ASSERT_TRUE(model.positions().allFinite());
      at_rest = report.status == StepStatus::kConverged ? at_rest + 1 : 0;
      refactor(model);
    }
    const double away = (model.positions() - rest).colwise().norm().maxCoeff();
    RecordProperty(mirrored ? "mirrored" : "random", std::to_string(away));
    EXPECT_LT(away, 1e-6) << (mirrored ? "mirrored" : "random");
  }
}

}  // namespace
}  // namespace palpate::elasticity
