#include "core/estimation/patch_motion.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/corotational_model.hpp"
#include "core/estimation/hand_follower.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using elasticity::CorotationalQuasistatic;

/// A weightless bar at rest whose compliance in the hand is about equal to its bending.
class GivingBar {
 public:
  GivingBar() {
    body_ = support::held_bar({3, 1, 1}, mesh::ElementOrder::kQuadratic);
    elasticity::GraspRegion& grasp = body_.grasps[0];
    grasp.compliance.diagonal() << 2e-3, 5e-3, 5e-3, 2, 1, 1;
    grasp.object_compliance.diagonal() << 1e-3, 3e-3, 3e-3, 1, 2, 1;
    hand_ = grasp.X_OG_rest;
    body_.gravity_O.setZero();
  }

  /// Brings bar and grasp to rest under this offset (m, rad, in G) of the hand.
  CorotationalQuasistatic& settle(const math::Vector6d& offset) {
    model_ = std::make_unique<CorotationalQuasistatic>(body_);
    model_->prepare();
    follower_.activate(*model_);
    const math::Pose correction =
        math::make_pose(math::exp_rotation(offset.tail<3>()), offset.head<3>());
    GraspInput input;
    input.pose_freshness = Freshness::kNew;
    input.holding = true;
    input.X_OG = hand_;
    for (int i = 0; i < 4000; ++i) {
      if (elasticity::Refactorisation* job = model_->wanted_refactorisation()) {
        job->run();
        model_->install(*job);
      }
      static_cast<void>(follower_.follow(0, input, 1e-3, *model_, correction));
      model_->step(1e-3);
    }
    return *model_;
  }
  const HandFollower& follower() const { return follower_; }

 private:
  elasticity::Body body_;
  math::Pose hand_;
  HandFollower follower_{HandFollower::Options{}};
  std::unique_ptr<CorotationalQuasistatic> model_;
};

TEST(PatchMotionTest, IsWhatAGivingGraspDoes) {
  GivingBar bar;
  const WrenchFilter filter(1, {});
  PatchMotion motion(filter.shape_size());
  CorotationalQuasistatic& model = bar.settle(math::Vector6d::Zero());
  ASSERT_TRUE(model.sensitivity().valid);
  motion.update(model, filter, {bar.follower().X_OG(0), math::Pose::Identity()}, 1);
  const math::Matrix6d wrench = motion.wrench_by_state().topLeftCorner<6, 6>();
  const math::Matrix6d held =
      model.sensitivity().dw_dxi[0][0] * math::both_halves(bar.follower().X_OG(0).linear());
  const Eigen::MatrixXd shape =
      model.sensitivity().dx_dxi[0] * motion.by_state().topLeftCorner<6, 6>();

  for (int i = 0; i < 6; ++i) {
    const double step = i < 3 ? 1e-4 : 1e-3;
    math::Vector6d offset = math::Vector6d::Zero();
    offset[i] = step;
    CorotationalQuasistatic& there = bar.settle(offset);
    const math::Vector6d w = there.reaction(0).vector();
    const Eigen::Matrix3Xd x = there.positions();
    CorotationalQuasistatic& back = bar.settle(-offset);
    const math::Vector6d change = (w - back.reaction(0).vector()) / (2 * step);
    const Eigen::MatrixXd moved = Eigen::Matrix3Xd((x - back.positions()) / (2 * step)).reshaped();
    EXPECT_LT((change - wrench.col(i)).norm(), 0.02 * change.norm()) << i;
    EXPECT_LT((moved - shape.col(i)).norm(), 0.02 * moved.norm()) << i;
    EXPECT_GT((change - held.col(i)).norm(), 0.1 * change.norm()) << i << ": it deforms";
  }
}

TEST(PatchMotionTest, IsThatOfTheHandWhereTheGraspIsFirm) {
  elasticity::Body body = support::held_bar({3, 1, 1}, mesh::ElementOrder::kQuadratic);
  CorotationalQuasistatic model(body);
  model.prepare();
  model.hold(0, body.grasps[0].X_OG_rest);
  for (int i = 0; i < 50; ++i) {
    if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
      job->run();
      model.install(*job);
    }
    model.step(1e-3);
  }
  ASSERT_TRUE(model.sensitivity().valid);
  const WrenchFilter filter(1, {});
  PatchMotion motion(filter.shape_size());
  motion.update(model, filter, {body.grasps[0].X_OG_rest, math::Pose::Identity()}, 1.3);
  EXPECT_TRUE(motion.felt().isIdentity(1e-12));
  EXPECT_TRUE(motion.by_state().isIdentity(1e-12));
}

}  // namespace
}  // namespace palpate::estimation
