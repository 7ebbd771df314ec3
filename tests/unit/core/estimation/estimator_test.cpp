#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/elasticity/body.hpp"
#include "core/estimation/force_driven.hpp"
#include "core/estimation/pose_driven.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using contact::ContactLoads;
using Eigen::Vector3d;
using sensing::Source;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ContactLoads load(Source source, std::vector<contact::NodalLoad> loads) {
  ContactLoads contact;
  contact.source = source;
  contact.accepted = true;
  contact.loads = std::move(loads);
  return contact;
}

class EstimatorTest : public ::testing::Test {
 protected:
  EstimatorTest() {
    inputs_.grasp_count = 1;
    inputs_.grasps[0].pose_freshness = Freshness::kNew;
    inputs_.grasps[0].holding = true;
    inputs_.grasps[0].X_OG = model_.body().grasps[0].X_OG_rest;
  }

  UpdateResult update(Estimator& estimator) {
    inputs_.contact_count = static_cast<int>(contacts_.size());
    inputs_.contacts = contacts_.data();
    const int before = model_.steps;
    const UpdateResult result = estimator.update(inputs_, model_, estimate_);
    EXPECT_EQ(model_.steps, before + 1);
    EXPECT_TRUE(model_.loads().allFinite());
    return result;
  }

  double load_on(int node, int axis) { return model_.loads()(axis, node); }

  support::RigidModel model_{support::held_bar({4, 1, 1}, mesh::ElementOrder::kLinear)};
  EstimationInputs inputs_;
  std::vector<ContactLoads> contacts_;
  Estimate estimate_;
};

TEST_F(EstimatorTest, GraspPoseFitsARigidMotion) {
  const math::Pose X = math::make_pose(math::exp_rotation({1, -2, 0.5}), Vector3d(0.1, 0.2, 0.3));
  model_.hold(0, X);
  model_.step(1e-3);
  EXPECT_TRUE(elasticity::grasp_pose(model_.body(), 0, model_.positions()).isApprox(X, 1e-9));
}

class PoseDrivenTest : public EstimatorTest {
 protected:
  PoseDrivenTest() { estimator_.activate(model_); }
  PoseDriven estimator_{PoseDriven::Options{}};
};

TEST_F(PoseDrivenTest, ActivatesHoldingAtRestUnderGravity) {
  EXPECT_TRUE(model_.is_held(0));
  EXPECT_TRUE(model_.X_OG(0).isApprox(model_.body().grasps[0].X_OG_rest));
  EXPECT_EQ(model_.gravity(), Vector3d(0, 0, -9.81));
  EXPECT_EQ(model_.steps, 0);
}

TEST_F(PoseDrivenTest, HoldsTheGraspAtTheHand) {
  math::Pose& X_OG = inputs_.grasps[0].X_OG;
  for (int i = 0; i < 50; ++i) {
    X_OG.translation().z() += 0.1e-3;
    X_OG.linear() = math::exp_rotation({0, 1e-3, 0}) * X_OG.linear();
    EXPECT_EQ(update(estimator_).status, Status::kOk);
    EXPECT_TRUE(model_.X_OG(0).isApprox(X_OG, 1e-12));
  }
  EXPECT_TRUE(estimate_.X_OG[0].isApprox(X_OG, 1e-12));
  EXPECT_EQ(estimate_.step.status, elasticity::StepStatus::kConverged);
  EXPECT_NEAR(estimate_.log_young_modulus, std::log(30e3), 1e-12);
  EXPECT_DOUBLE_EQ(estimate_.poisson_ratio, 0.3);
}

TEST_F(PoseDrivenTest, ApproachesAFarPoseAtItsSpeed) {
  math::Pose& X_OG = inputs_.grasps[0].X_OG;
  X_OG.translation().z() += 0.05;
  math::Pose before = model_.X_OG(0);
  int ticks = 0;
  while (update(estimator_).status == Status::kDegraded && ticks < 1000) {
    ++ticks;
    EXPECT_LT((model_.X_OG(0).translation() - before.translation()).norm(), 1e-3 + 1e-9);
    before = model_.X_OG(0);
  }
  EXPECT_NEAR(ticks, 45, 1) << "until it is five steps away";
  for (int i = 0; i < 5; ++i) static_cast<void>(update(estimator_));
  EXPECT_TRUE(model_.X_OG(0).isApprox(X_OG, 1e-12));
}

TEST_F(PoseDrivenTest, AGapOfTwentyMillisecondsOfAMovingHandIsNoTrouble) {
  math::Pose& X_OG = inputs_.grasps[0].X_OG;
  static_cast<void>(update(estimator_));
  for (int gap = 0; gap < 5; ++gap) {
    for (int i = 0; i < 22; ++i) {
      X_OG.translation().z() += 0.1e-3;
      inputs_.grasps[0].pose_freshness = i < 20 ? Freshness::kOld : Freshness::kNew;
      EXPECT_EQ(update(estimator_).status, Status::kOk);
    }
    EXPECT_NEAR(model_.X_OG(0).translation().z(), X_OG.translation().z(), 0.21e-3);
  }
}

TEST_F(PoseDrivenTest, AnOldPoseHoldsAndBecomesStale) {
  static_cast<void>(update(estimator_));
  inputs_.grasps[0].pose_freshness = Freshness::kOld;
  int good = 0;
  while (update(estimator_).status == Status::kOk && good < 1000) ++good;
  EXPECT_NEAR(good, 50, 1);  // 0.05 s
  EXPECT_THAT(update(estimator_).reason, ::testing::HasSubstr("stale"));
  EXPECT_TRUE(model_.is_held(0));
  inputs_.grasps[0].pose_freshness = Freshness::kNew;
  EXPECT_EQ(update(estimator_).status, Status::kOk);
}

TEST_F(PoseDrivenTest, WithoutAnyPoseItHoldsAtRest) {
  inputs_.grasps[0].pose_freshness = Freshness::kNoData;
  inputs_.grasps[0].X_OG.translation().setConstant(7);
  EXPECT_EQ(update(estimator_).status, Status::kDegraded);
  EXPECT_TRUE(model_.X_OG(0).isApprox(model_.body().grasps[0].X_OG_rest));
}

TEST_F(PoseDrivenTest, LetsGoAndTakesUpWhereTheObjectIs) {
  static_cast<void>(update(estimator_));
  inputs_.grasps[0].holding = false;
  inputs_.grasps[0].X_OG.translation().z() += 0.02;
  static_cast<void>(update(estimator_));
  EXPECT_FALSE(model_.is_held(0));
  inputs_.grasps[0].holding = true;
  EXPECT_EQ(update(estimator_).status, Status::kDegraded);
  EXPECT_TRUE(model_.is_held(0));
  EXPECT_NEAR(model_.X_OG(0).translation().z(), 0.03 + 1e-3, 1e-9);
}

TEST_F(PoseDrivenTest, AppliesContactsButNotTheWrist) {
  contacts_ = {load(Source::kWrist0, {{3, {1, 1, 1}}}), load(Source::kFinger2, {{5, {0, 0, -2}}}),
               load(Source::kManual, {{5, {0, 0, -1}}, {6, {0, 1, 0}}})};
  ContactLoads refused = load(Source::kFinger0, {{7, {9, 9, 9}}});
  refused.accepted = false;
  contacts_.push_back(refused);
  EXPECT_EQ(update(estimator_).status, Status::kOk);
  EXPECT_EQ(model_.loads().col(3).norm(), 0);
  EXPECT_EQ(load_on(5, 2), -3);
  EXPECT_EQ(load_on(6, 1), 1);
  EXPECT_EQ(model_.loads().col(7).norm(), 0);
  contacts_.clear();
  static_cast<void>(update(estimator_));
  EXPECT_EQ(model_.loads().norm(), 0);
}

TEST_F(PoseDrivenTest, PassesNoNonsenseOn) {
  static_cast<void>(update(estimator_));
  const math::Pose good = model_.X_OG(0);
  inputs_.grasps[0].X_OG.matrix()(0, 3) = kNan;
  inputs_.dt = kNan;
  contacts_ = {load(Source::kManual, {{5, {0, kNan, 0}}, {-1, {1, 0, 0}}, {6, {0, 1, 0}}})};
  EXPECT_EQ(update(estimator_).status, Status::kDegraded);
  EXPECT_TRUE(model_.X_OG(0).isApprox(good));
  EXPECT_EQ(model_.last_dt, 1e-3);
  EXPECT_EQ(model_.loads().sum(), 1);
}

TEST_F(PoseDrivenTest, AFailingModelDegradesThenFaults) {
  static_cast<void>(update(estimator_));
  model_.report.status = elasticity::StepStatus::kFailed;
  EXPECT_EQ(update(estimator_).status, Status::kDegraded);
  UpdateResult result;
  for (int i = 0; i < 600; ++i) result = update(estimator_);
  EXPECT_EQ(result.status, Status::kFault);
  model_.report = {elasticity::StepStatus::kNotConverged, 2, 1e-3};
  EXPECT_EQ(update(estimator_).status, Status::kOk);  // in transit
  model_.report.residual = 1;
  for (int i = 0; i < 600; ++i) result = update(estimator_);
  EXPECT_EQ(result.status, Status::kDegraded);
}

class ForceDrivenTest : public EstimatorTest {
 protected:
  static ForceDriven::Options as_released() {
    ForceDriven::Options options;
    options.variant = ForceDriven::Variant::kAsReleased;
    return options;
  }
};

TEST_F(ForceDrivenTest, HoldsNothing) {
  model_.hold(0, math::Pose::Identity());
  ForceDriven repaired(model_.body(), ForceDriven::Options{});
  repaired.activate(model_);
  EXPECT_FALSE(model_.is_held(0));
  EXPECT_EQ(model_.gravity(), Vector3d(0, 0, -9.81));
  ForceDriven released(model_.body(), as_released());
  released.activate(model_);
  EXPECT_EQ(model_.gravity(), Vector3d(Vector3d::Zero()));
}

TEST_F(ForceDrivenTest, RepairedAppliesAllLoadsAndTheirTorque) {
  ForceDriven estimator(model_.body(), ForceDriven::Options{});
  estimator.activate(model_);
  contacts_ = {load(Source::kWrist0, {{18, {0, 0, 1}}, {19, {0, 0, -1}}}),
               load(Source::kFinger1, {{5, {0, 2, 0}}})};
  EXPECT_EQ(update(estimator).status, Status::kOk);
  EXPECT_EQ(load_on(18, 2), 1);
  EXPECT_EQ(load_on(19, 2), -1);
  EXPECT_EQ(load_on(5, 1), 2);
  const Eigen::Matrix3Xd& x = model_.positions();
  EXPECT_LT(estimate_.reaction[0].force.norm(), 1e-12);
  EXPECT_LT(
      (estimate_.reaction[0].torque - (x.col(18) - x.col(19)).cross(Vector3d::UnitZ())).norm(),
      1e-12);
  EXPECT_TRUE(estimate_.X_OG[0].isApprox(model_.body().grasps[0].X_OG_rest, 1e-9));
}

TEST_F(ForceDrivenTest, RepairedFadesWhatNoLongerComes) {
  ForceDriven estimator(model_.body(), ForceDriven::Options{});
  estimator.activate(model_);
  contacts_ = {load(Source::kWrist0, {{18, {0, 0, 1}}}), load(Source::kManual, {{5, {2, 0, 0}}})};
  static_cast<void>(update(estimator));
  contacts_.erase(contacts_.begin());
  double last = 1;
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(update(estimator).status, Status::kDegraded);
    EXPECT_LT(load_on(18, 2), last);
    last = load_on(18, 2);
  }
  EXPECT_NEAR(last, 0.5, 1e-9);  // half of 0.1 s
  for (int i = 0; i < 51; ++i) static_cast<void>(update(estimator));
  EXPECT_EQ(load_on(18, 2), 0);
  EXPECT_EQ(load_on(5, 0), 2);
  contacts_.push_back(load(Source::kWrist0, {{18, {0, 0, 1}}}));
  EXPECT_EQ(update(estimator).status, Status::kOk);
  EXPECT_EQ(load_on(18, 2), 1);
}

TEST_F(ForceDrivenTest, AsReleasedAveragesAndDelays) {
  ForceDriven estimator(model_.body(), as_released());
  estimator.activate(model_);
  const auto push = [&](double f) {
    contacts_ = {load(Source::kWrist0, {{18, {0, 0, 0.25 * f}}, {19, {0, 0, 0.75 * f}}})};
    EXPECT_EQ(update(estimator).status, Status::kOk);
    return load_on(18, 2) + load_on(19, 2);
  };
  for (int i = 0; i < 300; ++i) push(1);
  // A step from 1 to 3: nothing for 12 ms, then a ramp of 100 ms.
  for (int i = 0; i < 12; ++i) EXPECT_NEAR(push(3), 1, 1e-9) << i;
  for (int i = 1; i <= 100; ++i) EXPECT_NEAR(push(3), 1 + 0.02 * i, 1e-9) << i;
  EXPECT_NEAR(push(3), 3, 1e-9);
  EXPECT_NEAR(load_on(18, 2), 0.75, 1e-9);
}

TEST_F(ForceDrivenTest, AsReleasedHoldsTheLastForceForEverAndDropsTorque) {
  ForceDriven estimator(model_.body(), as_released());
  estimator.activate(model_);
  // Force 2 along z and a couple along y.
  contacts_ = {load(Source::kWrist0, {{18, {1, 0, 1}}, {19, {-1, 0, 1}}})};
  for (int i = 0; i < 200; ++i) static_cast<void>(update(estimator));
  EXPECT_NEAR(load_on(18, 2), 1, 1e-9);
  EXPECT_NEAR(load_on(18, 0), 0, 1e-9);
  EXPECT_NEAR(load_on(19, 2), 1, 1e-9);
  contacts_.clear();
  for (int i = 0; i < 5000; ++i) EXPECT_EQ(update(estimator).status, Status::kOk);
  EXPECT_NEAR(load_on(18, 2), 1, 1e-9);
  EXPECT_NEAR(estimate_.reaction[0].force.z(), 2, 1e-9);
}

TEST_F(ForceDrivenTest, PassesNoNonsenseOn) {
  for (const ForceDriven::Options& options : {ForceDriven::Options{}, as_released()}) {
    ForceDriven estimator(model_.body(), options);
    estimator.activate(model_);
    contacts_ = {load(Source::kWrist0, {{18, {0, 0, 1}}})};
    for (int i = 0; i < 200; ++i) static_cast<void>(update(estimator));
    contacts_ = {load(Source::kWrist0, {{18, {0, kNan, 1}}, {99999, {1, 1, 1}}})};
    EXPECT_EQ(update(estimator).status, Status::kDegraded);
    EXPECT_GT(load_on(18, 2), 0.9);  // the last valid one
  }
}

TEST_F(ForceDrivenTest, SensingLaunchIsSlower) {
  const ForceDriven::Options options = ForceDriven::Options::sensing_launch();
  EXPECT_EQ(options.variant, ForceDriven::Variant::kAsReleased);
  EXPECT_DOUBLE_EQ(options.average, 300 / 500.0);
  EXPECT_DOUBLE_EQ(options.delay, 80 / 500.0);
}

TEST(Estimators, RefuseBadOptions) {
  PoseDriven::Options pose;
  pose.hand.approach_speed = 0;
  EXPECT_THROW(PoseDriven{pose}, std::invalid_argument);
  ForceDriven::Options force;
  force.period = 0;
  const elasticity::Body body = support::held_bar({1, 1, 1}, mesh::ElementOrder::kLinear);
  EXPECT_THROW(ForceDriven(body, force), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::estimation
