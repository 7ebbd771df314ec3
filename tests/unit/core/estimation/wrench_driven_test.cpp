#include "core/estimation/wrench_driven.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "core/elasticity/corotational_model.hpp"
#include "core/estimation/pose_driven.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using elasticity::CorotationalQuasistatic;

elasticity::Body bar() { return support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic); }

class WrenchDrivenTest : public ::testing::Test {
 protected:
  void start(const elasticity::Body& body, const WrenchDriven::Options& options = {}) {
    model_ = std::make_unique<CorotationalQuasistatic>(body);
    model_->prepare();
    estimator_ = std::make_unique<WrenchDriven>(body, options);
    estimator_->activate(*model_);
    inputs_.grasp_count = static_cast<int>(body.grasps.size());
    for (int g = 0; g < inputs_.grasp_count; ++g) {
      inputs_.grasps[g].pose_freshness = Freshness::kNew;
      inputs_.grasps[g].holding = inputs_.grasps[g].wrench_valid = true;
    }
  }
  UpdateResult tick() {
    refactor();
    return estimator_->update(inputs_, *model_, estimate_);
  }
  void refactor() {
    if (elasticity::Refactorisation* job = model_->wanted_refactorisation()) {
      job->run();
      model_->install(*job);
    }
  }
  UpdateResult run(double seconds) {
    UpdateResult result;
    for (int i = 0; i < std::lround(1e3 * seconds); ++i) result = tick();
    return result;
  }
  double distance(const Eigen::Matrix3Xd& shape) const {
    return (model_->positions() - shape).colwise().norm().maxCoeff();
  }
  /// Moves a hand of another such object to X_OG within a second and feeds the estimator the
  /// measurements of all its hands. Returns the final shape.
  Eigen::Matrix3Xd feel(const elasticity::Body& body, const math::Pose& X_OG, int grasp = 0) {
    CorotationalQuasistatic world(body);
    world.prepare();
    math::Pose hand = body.grasps[grasp].X_OG_rest;
    const Vector3d way = X_OG.translation() - hand.translation();
    const Vector3d turn = math::log_rotation(X_OG.linear() * hand.linear().transpose());
    for (int i = 0; i < 1500; ++i) {
      if (i < 1000) {
        hand.translation() += 1e-3 * way;
        hand.linear() = math::exp_rotation(1e-3 * turn) * hand.linear();
      }
      for (int g = 0; g < inputs_.grasp_count; ++g)
        world.hold(g, g == grasp ? hand : body.grasps[g].X_OG_rest);
      if (elasticity::Refactorisation* job = world.wanted_refactorisation()) {
        job->run();
        world.install(*job);
      }
      world.step(1e-3);
      for (int g = 0; g < inputs_.grasp_count; ++g) inputs_.grasps[g].F_G_O = world.reaction(g);
      static_cast<void>(tick());
    }
    return world.positions();
  }
  static math::Pose bent(const elasticity::Body& body) {
    math::Pose X_OG = body.grasps[0].X_OG_rest;
    X_OG.translation() += Vector3d(-0.03, 0.04, 0.08);
    X_OG.linear() = math::exp_rotation({0.5, -0.4, 0.3});
    return X_OG;
  }

  std::unique_ptr<CorotationalQuasistatic> model_;
  std::unique_ptr<WrenchDriven> estimator_;
  EstimationInputs inputs_;
  Estimate estimate_;
};

TEST_F(WrenchDrivenTest, AWrenchAtTheTipBendsTheBarAsBeamTheorySays) {
  elasticity::Body body = bar();
  body.gravity_O.setZero();
  body.material.poisson_ratio = 0;
  start(body);
  const double EI = 30e3 * std::pow(0.06, 4) / 12;     // N m^2
  const double GA = 30e3 / 2 * 0.06 * 0.06 * 5.0 / 6;  // N
  const double L = 0.5, force = 0.01, couple = -0.003;
  inputs_.grasps[0].F_G_O.force.z() = force;
  inputs_.grasps[0].F_G_O.torque.y() = -couple;  // rotates z towards -x: lifts the tip
  EXPECT_EQ(run(2).status, Status::kOk);
  const double rise = force * L * L * L / (3 * EI) + force * L / GA + couple * L * L / (2 * EI);
  const double slope = force * L * L / (2 * EI) + couple * L / EI;
  ASSERT_GT(rise, 1e-3);
  EXPECT_NEAR(estimate_.X_OG[0].translation().z() - 0.03, rise, 0.03 * rise);
  const Vector3d turn = math::log_rotation(estimate_.X_OG[0].linear());
  EXPECT_NEAR(-turn.y(), slope, 0.03 * std::abs(slope) + 0.001);
  EXPECT_LT((estimate_.reaction[0].vector() - inputs_.grasps[0].F_G_O.vector()).norm(), 1e-5);
}

TEST_F(WrenchDrivenTest, FindsThePoseAndShapeThatMadeTheWrench) {
  const elasticity::Body body = bar();
  start(body);
  const math::Pose X_OG = bent(body);
  const Eigen::Matrix3Xd truth = feel(body, X_OG);
  ASSERT_GT(distance(body.mesh.nodes), 0.05);
  EXPECT_EQ(run(1).status, Status::kOk);
  EXPECT_LT(distance(truth), 1e-4);
  EXPECT_LT((estimate_.X_OG[0].translation() - X_OG.translation()).norm(), 1e-4);
  EXPECT_LT(math::log_rotation(estimate_.X_OG[0].linear() * X_OG.linear().transpose()).norm(),
            1e-3);
}

TEST_F(WrenchDrivenTest, FindsAlsoWhatOnlyTheHandKeepsFromSnapping) {
  // Compressed by a tenth: buckled, and displaced sideways by gravity.
  const elasticity::Body body = bar();
  start(body);
  math::Pose X_OG = body.grasps[0].X_OG_rest;
  PoseDriven by_pose{PoseDriven::Options{}};
  by_pose.activate(*model_);
  for (int i = 0; i < 1500; ++i) {
    if (i < 1000) X_OG.translation().x() -= 5e-5;
    inputs_.grasps[0].X_OG = X_OG;
    refactor();
    static_cast<void>(by_pose.update(inputs_, *model_, estimate_));
  }
  const Eigen::Matrix3Xd truth = model_->positions();
  const Eigen::SelfAdjointEigenSolver<math::Matrix6d> modes(
      0.5 * (model_->sensitivity().dw_dxi[0][0] + model_->sensitivity().dw_dxi[0][0].transpose()));
  EXPECT_LT(modes.eigenvalues()[0], 0) << "dead loads would not hold it";
  inputs_.grasps[0].F_G_O = estimate_.reaction[0];
  estimate_.X_OG[0].translation() += Vector3d(0.002, 0.004, -0.006);
  estimator_->take_over(estimate_, *model_);
  static_cast<void>(run(3));
  EXPECT_LT(distance(truth), 5e-4);
}

TEST_F(WrenchDrivenTest, AStiffObjectHardlyMovesWhateverTheHandFeels) {
  elasticity::Body body = bar();
  body.mesh.nodes.row(0) *= 0.2;
  for (elasticity::GraspRegion& grasp : body.grasps) grasp.X_OG_rest.translation().x() *= 0.2;
  body.material.young_modulus = 1e9;
  start(body);
  inputs_.grasps[0].F_G_O.force = Vector3d(20, -10, 30);
  static_cast<void>(run(1));
  EXPECT_LT(distance(body.mesh.nodes), 2e-5);
  EXPECT_GT(distance(body.mesh.nodes), 1e-9);
  EXPECT_LT((estimate_.reaction[0].vector() - inputs_.grasps[0].F_G_O.vector()).norm(), 0.05);
}

TEST_F(WrenchDrivenTest, TheSensorsNoiseMovesABentBarByMillimetres) {
  const elasticity::Body body = bar();
  start(body);
  const Eigen::Matrix3Xd truth = feel(body, bent(body));
  const math::Wrench wrench = inputs_.grasps[0].F_G_O;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double square = 0;
  constexpr int kTicks = 3000;
  for (int i = 0; i < kTicks; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      inputs_.grasps[0].F_G_O.force[axis] = wrench.force[axis] + 0.025 * normal(random);
      inputs_.grasps[0].F_G_O.torque[axis] = wrench.torque[axis] + 0.001 * normal(random);
    }
    EXPECT_EQ(tick().status, Status::kOk);
    square += std::pow(distance(truth), 2) / kTicks;
  }
  std::printf("worst node, root mean square: %.1f mm\n", 1e3 * std::sqrt(square));
  EXPECT_LT(std::sqrt(square), 5e-3);
}

TEST_F(WrenchDrivenTest, AStaleWrenchDegradesAndTheGraspStays) {
  const elasticity::Body body = bar();
  start(body);
  inputs_.grasps[0].wrench_valid = false;
  EXPECT_EQ(tick().status, Status::kOk) << "one may come";
  EXPECT_THAT(run(0.06).reason, ::testing::HasSubstr("no wrench"));
  inputs_.grasps[0].wrench_valid = true;
  feel(body, bent(body));
  inputs_.grasps[0].wrench_valid = false;
  static_cast<void>(run(0.051));
  const math::Pose held = estimate_.X_OG[0];
  const UpdateResult result = run(0.1);
  EXPECT_EQ(result.status, Status::kDegraded);
  EXPECT_THAT(result.reason, ::testing::HasSubstr("stale"));
  EXPECT_EQ(estimate_.X_OG[0].matrix(), held.matrix());
  inputs_.grasps[0].wrench_valid = true;
  inputs_.grasps[0].F_G_O.torque.x() = std::nan("");
  EXPECT_EQ(run(0.1).status, Status::kDegraded);
  EXPECT_EQ(estimate_.X_OG[0].matrix(), held.matrix());
  inputs_.grasps[0].F_G_O.torque.x() = held.translation().y();  // N m, some other
  EXPECT_EQ(run(0.1).status, Status::kOk);
  EXPECT_NE(estimate_.X_OG[0].matrix(), held.matrix());
}

TEST_F(WrenchDrivenTest, SaysWhereNoPoseHasTheWrench) {
  elasticity::Body body = bar();
  body.gravity_O.setZero();
  start(body);
  inputs_.grasps[0].F_G_O.torque.x() = 2;  // N m: dozens of turns
  const UpdateResult result = run(2);
  EXPECT_EQ(result.status, Status::kDegraded);
  EXPECT_THAT(result.reason, ::testing::HasSubstr("no pose"));
}

TEST_F(WrenchDrivenTest, WhatIsLetGoHangsFreeAndIsTakenUpThere) {
  const elasticity::Body body = bar();
  start(body);
  feel(body, body.grasps[0].X_OG_rest);
  inputs_.grasps[0].holding = false;
  static_cast<void>(run(0.5));
  EXPECT_FALSE(model_->is_held(0));
  EXPECT_EQ(estimate_.reaction[0].force.norm(), 0);
  const Eigen::Matrix3Xd hanging = model_->positions();
  inputs_.grasps[0].holding = true;
  inputs_.grasps[0].wrench_valid = false;
  static_cast<void>(tick());
  EXPECT_TRUE(model_->is_held(0));
  EXPECT_LT(distance(hanging), 5e-3);
}

TEST_F(WrenchDrivenTest, TwoHandsMeetBothWrenches) {
  elasticity::Body body = bar();
  elasticity::GraspRegion middle;
  for (int i = 0; i < body.mesh.node_count(); ++i) {
    if (std::abs(body.mesh.nodes(0, i) - 0.25) < 1e-9) middle.nodes.push_back(i);
  }
  middle.X_OG_rest.translation() << 0.25, 0.03, 0.03;
  body.grasps.push_back(middle);
  start(body);
  math::Pose X_OG = body.grasps[1].X_OG_rest;
  X_OG.translation() += Vector3d(0.005, 0.01, 0.02);
  const Eigen::Matrix3Xd truth = feel(body, X_OG, 1);
  EXPECT_EQ(run(1).status, Status::kOk);
  EXPECT_LT(distance(truth), 2e-4);
}

TEST_F(WrenchDrivenTest, TakesOverFromThePoseAndGivesBackWithoutAJump) {
  const elasticity::Body body = bar();
  start(body);
  PoseDriven by_pose{PoseDriven::Options{}};
  by_pose.activate(*model_);
  inputs_.grasps[0].X_OG = bent(body);
  for (int i = 0; i < 800; ++i) {
    refactor();
    static_cast<void>(by_pose.update(inputs_, *model_, estimate_));
  }
  // The sensor's reading differs slightly from the model's reaction.
  inputs_.grasps[0].F_G_O = estimate_.reaction[0];
  inputs_.grasps[0].F_G_O.force += Vector3d(0.01, -0.01, 0.02);
  for (const bool to_wrench : {true, false}) {
    Estimator& next = to_wrench ? static_cast<Estimator&>(*estimator_) : by_pose;
    const Eigen::Matrix3Xd before = model_->positions();
    ASSERT_TRUE(model_->restore(before, model_->velocities()));
    next.take_over(estimate_, *model_);
    refactor();
    static_cast<void>(next.update(inputs_, *model_, estimate_));
    EXPECT_LT(distance(before), 1.2e-3) << "one step of 1 m/s, " << to_wrench;
    for (int i = 0; i < 600; ++i) {
      refactor();
      static_cast<void>(next.update(inputs_, *model_, estimate_));
    }
    EXPECT_EQ(next.update(inputs_, *model_, estimate_).status, Status::kOk);
  }
  EXPECT_TRUE(estimate_.X_OG[0].isApprox(inputs_.grasps[0].X_OG, 1e-9));
}

TEST_F(WrenchDrivenTest, ADynamicModelIsAFault) {
  const elasticity::Body body = bar();
  elasticity::CorotationalDynamic model(body);
  model.prepare();
  WrenchDriven estimator(body, {});
  estimator.activate(model);
  inputs_.grasp_count = 1;
  UpdateResult result;
  for (int i = 0; i < 3; ++i) result = estimator.update(inputs_, model, estimate_);
  EXPECT_EQ(result.status, Status::kFault);
}

TEST_F(WrenchDrivenTest, AModelWithoutStiffnessDegrades) {
  elasticity::Body body = bar();
  support::RigidModel model(body);
  WrenchDriven estimator(body, {});
  estimator.activate(model);
  inputs_.grasp_count = 1;
  inputs_.grasps[0].wrench_valid = true;
  UpdateResult result;
  for (int i = 0; i < 60; ++i) result = estimator.update(inputs_, model, estimate_);
  EXPECT_EQ(result.status, Status::kDegraded);
  EXPECT_THAT(result.reason, ::testing::HasSubstr("stiff"));
  EXPECT_TRUE(model.X_OG(0).isApprox(body.grasps[0].X_OG_rest));
}

TEST_F(WrenchDrivenTest, AllocatesNothing) {
  const elasticity::Body body = bar();
  start(body);
  inputs_.grasps[0].F_G_O.force.z() = 0.3;
  for (int i = 0; i < 100; ++i) {
    refactor();
    const loop::NoAllocationScope scope;
    static_cast<void>(estimator_->update(inputs_, *model_, estimate_));
    ASSERT_EQ(scope.count(), 0) << i;
  }
}

TEST_F(WrenchDrivenTest, OptionsAndBodiesThatMakeNoSenseAreRefused) {
  elasticity::Body body = bar();
  WrenchDriven::Options options;
  for (double* value : {&options.time_constant, &options.average, &options.least_stiffness,
                        &options.wrench_timeout, &options.speed, &options.angular_speed}) {
    const double good = *value;
    for (const double bad : {0.0, -1.0, std::nan("")}) {
      *value = bad;
      EXPECT_THROW(WrenchDriven(body, options), std::invalid_argument);
    }
    *value = good;
  }
  EXPECT_NO_THROW(WrenchDriven(body, options));
  body.fixed_nodes.clear();
  EXPECT_THROW(WrenchDriven(body, options), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::estimation
