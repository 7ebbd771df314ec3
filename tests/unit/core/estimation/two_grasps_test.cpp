// A bar held only by two hands, compared with the static solver.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/static_solver.hpp"
#include "core/estimation/pose_driven.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;

class TwoGrasps : public ::testing::Test {
 protected:
  TwoGrasps() {
    model_.prepare();
    estimator_.activate(model_);
    inputs_.grasp_count = 2;
    for (int i = 0; i < 2; ++i) {
      inputs_.grasps[i].pose_freshness = Freshness::kNew;
      inputs_.grasps[i].holding = true;
      inputs_.grasps[i].X_OG = body_.grasps[i].X_OG_rest;
    }
  }

  UpdateResult tick() {
    if (elasticity::Refactorisation* job = model_.wanted_refactorisation()) {
      job->run();
      model_.install(*job);
    }
    return estimator_.update(inputs_, model_, estimate_);
  }

  /// Minus the sum of both reactions, minus the weight: zero at equilibrium.
  Vector3d imbalance() const {
    const double mass = 26 * 0.5 * 0.06 * 0.06;
    return estimate_.reaction[0].force + estimate_.reaction[1].force + mass * body_.gravity_O;
  }

  elasticity::Body body_ = support::bar_between_hands(mesh::ElementOrder::kQuadratic);
  elasticity::CorotationalQuasistatic model_{body_};
  PoseDriven estimator_{PoseDriven::Options{}};
  EstimationInputs inputs_;
  Estimate estimate_;
};

TEST_F(TwoGrasps, ShapeAndBothWrenchesAreThoseOfTheStaticSolver) {
  const Vector3d way[2] = {{-0.02, 0.01, 0.04}, {0.01, -0.02, -0.03}};
  const Vector3d turn[2] = {{0.3, 0.1, -0.2}, {-0.2, -0.3, 0.1}};
  constexpr int kTicks = 400;
  for (int i = 0; i < kTicks + 100; ++i) {
    const double share = std::min(1.0, static_cast<double>(i + 1) / kTicks);
    for (int g = 0; g < 2; ++g) {
      inputs_.grasps[g].X_OG =
          math::make_pose(math::exp_rotation(share * turn[g]),
                          body_.grasps[g].X_OG_rest.translation() + share * way[g]);
    }
    const UpdateResult result = tick();
    if (i > kTicks) {
      EXPECT_EQ(result.status, Status::kOk) << result.reason;
    }
  }
  const elasticity::HeldPoses held = {inputs_.grasps[0].X_OG, inputs_.grasps[1].X_OG};
  const Eigen::Matrix3Xd start = model_.positions();
  const elasticity::StaticSolution truth =
      solve_static(body_, Eigen::Matrix3Xd::Zero(3, body_.mesh.node_count()), held, {}, &start);
  ASSERT_TRUE(truth.converged);
  EXPECT_LT((model_.positions() - truth.positions).colwise().norm().maxCoeff(), 1e-6);
  for (int g = 0; g < 2; ++g) {
    EXPECT_TRUE(estimate_.X_OG[g].isApprox(*held[g], 1e-12)) << g;
    const math::Wrench expected =
        patch_wrench(body_.grasps[g], *held[g], truth.positions, truth.reactions);
    EXPECT_GT(expected.force.norm(), 0.1) << "N: they pull";
    EXPECT_LT((estimate_.reaction[g].force - expected.force).norm(),
              1e-3 * expected.force.norm() + 1e-4)
        << g;
    EXPECT_LT((estimate_.reaction[g].torque - expected.torque).norm(),
              1e-3 * expected.torque.norm() + 1e-4)
        << g;
  }
  EXPECT_LT(imbalance().norm(), 1e-3 * estimate_.reaction[0].force.norm());
}

TEST_F(TwoGrasps, OneStaleHandDegradesAndHoldsWhileTheOtherIsFollowed) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(tick().status, Status::kOk);
  const math::Pose before = estimate_.X_OG[1];
  inputs_.grasps[1].pose_freshness = Freshness::kOld;
  UpdateResult result;
  for (int i = 0; i < 60; ++i) {
    inputs_.grasps[0].X_OG.translation().z() += 1e-4;
    result = tick();
  }
  EXPECT_EQ(result.status, Status::kDegraded);
  EXPECT_THAT(result.reason, ::testing::HasSubstr("stale"));
  EXPECT_TRUE(estimate_.X_OG[1].isApprox(before, 1e-12));
  EXPECT_TRUE(estimate_.X_OG[0].isApprox(inputs_.grasps[0].X_OG, 1e-12));
  inputs_.grasps[1].pose_freshness = Freshness::kNew;
  EXPECT_EQ(tick().status, Status::kOk);
}

TEST_F(TwoGrasps, TheOtherHandCarriesWhatOneLetsGo) {
  for (int i = 0; i < 20; ++i) static_cast<void>(tick());
  inputs_.grasps[1].holding = false;
  for (int i = 0; i < 800; ++i) static_cast<void>(tick());
  EXPECT_FALSE(model_.is_held(1));
  EXPECT_EQ(estimate_.reaction[1].force.norm(), 0);
  EXPECT_LT(imbalance().norm(), 0.01 * estimate_.reaction[0].force.norm());
}

}  // namespace
}  // namespace palpate::estimation
