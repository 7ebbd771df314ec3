// Both estimators on the co-rotational model.
#include <gtest/gtest.h>

#include "core/elasticity/body.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/pad_compliance.hpp"
#include "core/estimation/force_driven.hpp"
#include "core/estimation/pose_driven.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using sensing::Source;

class BarTest : public ::testing::Test {
 protected:
  void start(const elasticity::Body& body, Estimator& estimator) {
    model_ = std::make_unique<elasticity::CorotationalQuasistatic>(body);
    model_->prepare();
    estimator.activate(*model_);
    inputs_.grasp_count = 1;
    inputs_.grasps[0].pose_freshness = Freshness::kNew;
    inputs_.grasps[0].holding = true;
    inputs_.grasps[0].X_OG = body.grasps[0].X_OG_rest;
    inputs_.contacts = &contact_;
  }

  UpdateResult tick(Estimator& estimator) {
    if (elasticity::Refactorisation* job = model_->wanted_refactorisation()) {
      job->run();
      model_->install(*job);
    }
    return estimator.update(inputs_, *model_, estimate_);
  }

  std::unique_ptr<elasticity::CorotationalQuasistatic> model_;
  EstimationInputs inputs_;
  contact::ContactLoads contact_;
  Estimate estimate_;
};

TEST_F(BarTest, AHandThatCarriesAFreeObjectMovesItRigidly) {
  elasticity::Body body = support::held_bar({6, 2, 2}, mesh::ElementOrder::kLinear);
  body.fixed_nodes.clear();
  body.gravity_O.setZero();
  PoseDriven estimator{PoseDriven::Options{}};
  start(body, estimator);
  math::Pose& X_OG = inputs_.grasps[0].X_OG;
  for (int i = 0; i < 800; ++i) {
    X_OG.translation() += Vector3d(1e-4, -2e-4, 1e-4);
    X_OG.linear() = math::exp_rotation({1e-3, 1e-3, -1e-3}) * X_OG.linear();
    static_cast<void>(tick(estimator));
  }
  for (int i = 0; i < 50; ++i) EXPECT_EQ(tick(estimator).status, Status::kOk);
  const math::Pose motion = X_OG * body.grasps[0].X_OG_rest.inverse();
  const Eigen::Matrix3Xd expected =
      (motion.linear() * body.mesh.nodes).colwise() + motion.translation();
  EXPECT_LT((model_->positions() - expected).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(estimate_.reaction[0].force.norm(), 1e-4);
}

// Soft pads and pads softer than the bar: at rest the bar is where spring and reaction balance.
TEST_F(BarTest, PadsGiveWayByTheirCompliance) {
  for (const double stiffness : {2e3, 100.0}) {
    elasticity::Body body = support::held_bar({6, 1, 1}, mesh::ElementOrder::kQuadratic);
    body.grasps[0].compliance = elasticity::pad_compliance(
        body, body.grasps[0], mesh::extract_surface(body.mesh), stiffness);
    PoseDriven estimator{PoseDriven::Options{}};
    start(body, estimator);
    math::Pose& X_OG = inputs_.grasps[0].X_OG;
    for (int i = 0; i < 6000; ++i) {
      if (i < 200) X_OG.translation() += Vector3d(0, 0, 1e-4);
      if (i < 200) X_OG.linear() = math::exp_rotation({1e-3, 0, 5e-4}) * X_OG.linear();
      static_cast<void>(tick(estimator));
    }
    const math::Pose& held = estimate_.X_OG[0];
    const math::Vector6d wrench =
        math::both_halves(held.linear()).transpose() * estimate_.reaction[0].vector();
    math::Vector6d give;
    const math::Pose in_hand = X_OG.inverse() * held;
    give << in_hand.translation(), math::log_rotation(in_hand.linear());
    const math::Vector6d expected = -(body.grasps[0].compliance * wrench);
    EXPECT_GT(give.norm(), 1e-3);
    EXPECT_LT((give - expected).norm(), 1e-3 * give.norm()) << stiffness << " N/m";

    // Another estimator that replaces it continues from there.
    PoseDriven next{PoseDriven::Options{}};
    const Eigen::Matrix3Xd before = model_->positions();
    next.take_over(estimate_, *model_);
    static_cast<void>(tick(next));
    EXPECT_LT((model_->positions() - before).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST_F(BarTest, ShapeUnderAPoseDoesNotDependOnStiffnessButTheWrenchDoes) {
  std::array<Eigen::Matrix3Xd, 2> shapes;
  std::array<math::Wrench, 2> reactions;
  for (int k = 0; k < 2; ++k) {
    elasticity::Body body = support::held_bar({6, 2, 2}, mesh::ElementOrder::kLinear);
    body.gravity_O.setZero();
    body.material.young_modulus = k == 0 ? 30e3 : 60e3;
    PoseDriven estimator{PoseDriven::Options{}};
    start(body, estimator);
    for (int i = 0; i < 500; ++i) {
      if (i < 300) inputs_.grasps[0].X_OG.translation() += Vector3d(0, 0, 1e-4);
      static_cast<void>(tick(estimator));
    }
    shapes[k] = model_->positions();
    reactions[k] = estimate_.reaction[0];
  }
  EXPECT_LT((shapes[0] - shapes[1]).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_GT(reactions[0].force.z(), 0);  // the hand pulls up
  EXPECT_NEAR(reactions[1].force.z() / reactions[0].force.z(), 2, 1e-3);
}

TEST_F(BarTest, ForceDrivenReturnsToThePoseThatMadeTheForce) {
  const elasticity::Body body = support::held_bar({6, 2, 2}, mesh::ElementOrder::kLinear);
  PoseDriven pose_driven{PoseDriven::Options{}};
  start(body, pose_driven);
  for (int i = 0; i < 600; ++i) {
    if (i < 400) inputs_.grasps[0].X_OG.translation() += Vector3d(0, 0, 1e-4);
    static_cast<void>(tick(pose_driven));
  }
  const double held_z =
      elasticity::grasp_pose(model_->body(), 0, model_->positions()).translation().z();
  const math::Wrench reaction = estimate_.reaction[0];

  // The same wrench as nodal loads on the grasp: force in equal parts, and the couple about y by
  // forces along x in proportion to height.
  const elasticity::GraspRegion& grasp = body.grasps[0];
  double second_moment = 0;
  for (int node : grasp.nodes) second_moment += std::pow(body.mesh.nodes(2, node) - 0.03, 2);
  contact_.source = Source::kWrist0;
  contact_.accepted = true;
  for (int node : grasp.nodes) {
    const double height = body.mesh.nodes(2, node) - 0.03;
    const Vector3d couple(reaction.torque.y() * height / second_moment, 0, 0);
    contact_.loads.push_back(
        {node, reaction.force / static_cast<double>(grasp.nodes.size()) + couple});
  }
  ForceDriven force_driven(body, ForceDriven::Options{});
  start(body, force_driven);
  inputs_.contact_count = 1;
  for (int i = 0; i < 3000; ++i) {
    static_cast<void>(tick(force_driven));
    if (i > 10 && estimate_.step.status == elasticity::StepStatus::kConverged) break;
  }
  RecordProperty("rise_of_grasp_mm", std::to_string(1e3 * (held_z - 0.03)));
  RecordProperty("rise_under_its_force_mm",
                 std::to_string(1e3 * (estimate_.X_OG[0].translation().z() - 0.03)));
  EXPECT_EQ(estimate_.step.status, elasticity::StepStatus::kConverged);
  EXPECT_NEAR(estimate_.X_OG[0].translation().z(), held_z, 0.05 * (held_z - 0.03));
  EXPECT_NEAR(estimate_.reaction[0].force.z(), reaction.force.z(), 1e-9);
}

}  // namespace
}  // namespace palpate::estimation
