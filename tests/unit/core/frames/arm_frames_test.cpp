#include "core/frames/arm_frames.hpp"

#include <gtest/gtest.h>

#include "core/math/constants.hpp"

namespace palpate::frames {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

math::Pose pose(const Vector3d& p, const Vector3d& rotation) {
  return math::make_pose(math::exp_rotation(rotation), p);
}

/// Frames without any special position or axis.
ArmFrames oblique() {
  ArmFrames frames;
  frames.X_WO = pose({0.4, -0.1, 0.2}, {0.3, -0.5, 1.1});
  frames.X_ES = pose({0.01, 0.02, 0.05}, {0, 0.2, 0.7});
  frames.X_EG = pose({-0.02, 0.03, 0.2}, {0.4, 0, -0.2});
  return frames;
}

const math::Pose kX_WE = pose({0.5, 0.3, 0.6}, {-0.8, 0.4, 0.2});

TEST(ArmFrames, PosesInTheObjectComposeThroughTheBase) {
  const ArmFrames frames = oblique();
  const Vector3d p_G(0.1, 0.2, 0.3);
  const Vector3d p_W = kX_WE * (frames.X_EG * p_G);
  EXPECT_TRUE((frames.X_WO * (frames.X_OG(kX_WE) * p_G)).isApprox(p_W, 1e-12));
  EXPECT_TRUE(frames.X_OG(kX_WE).isApprox(frames.X_OE(kX_WE) * frames.X_EG, 1e-12));
}

TEST(ArmFrames, AWrenchKeepsItsForceAndItsMomentAboutEveryPoint) {
  const ArmFrames frames = oblique();
  const math::Wrench F_S{{1, -2, 3}, {0.1, 0.4, -0.2}};
  const math::Pose X_OG = frames.X_OG(kX_WE);
  const math::Wrench F_O = frames.wrench_in_object(F_S, X_OG.linear());
  const math::Pose X_OS = frames.X_OE(kX_WE) * frames.X_ES;
  EXPECT_TRUE(F_O.force.isApprox(X_OS.linear() * F_S.force, 1e-12));
  // about the origin of O
  const Vector3d by_sensor =
      X_OS.linear() * F_S.torque + X_OS.translation().cross(X_OS.linear() * F_S.force);
  const Vector3d by_grasp = F_O.torque + X_OG.translation().cross(F_O.force);
  EXPECT_TRUE(by_grasp.isApprox(by_sensor, 1e-12));
}

TEST(ArmFrames, ATwistIsThatOfTheMovingGrasp) {
  const ArmFrames frames = oblique();
  const math::Twist V_W_E{{0.1, -0.2, 0.05}, {0.3, 0.1, -0.4}};
  const math::Twist V_O_G = frames.grasp_twist(V_W_E, kX_WE.linear());
  constexpr double kDt = 1e-6;
  math::Pose later = kX_WE;
  later.translation() += kDt * V_W_E.linear;
  later.linear() = math::exp_rotation(kDt * V_W_E.angular) * kX_WE.linear();
  const math::Pose X_OG = frames.X_OG(kX_WE), X_OG_later = frames.X_OG(later);
  const Vector3d linear = (X_OG_later.translation() - X_OG.translation()) / kDt;
  const Vector3d angular =
      math::log_rotation(X_OG_later.linear() * X_OG.linear().transpose()) / kDt;
  EXPECT_TRUE(V_O_G.linear.isApprox(linear, 1e-5));
  EXPECT_TRUE(V_O_G.angular.isApprox(angular, 1e-5));
}

TEST(ArmFrames, TwistsOfFlangeAndGraspAreInverse) {
  const ArmFrames frames = oblique();
  const math::Twist V_O_G{{0.1, -0.2, 0.05}, {0.3, 0.1, -0.4}};
  const math::Twist back =
      frames.grasp_twist(frames.flange_twist(V_O_G, kX_WE.linear()), kX_WE.linear());
  EXPECT_TRUE(back.vector().isApprox(V_O_G.vector(), 1e-12));
}

TEST(ArmFrames, NearPosesDifferInNeitherPlaceNorAngle) {
  EXPECT_TRUE(are_near(kX_WE, kX_WE, 1e-6, 1e-6));
  math::Pose moved = kX_WE;
  moved.translation().y() += 0.01;
  EXPECT_TRUE(are_near(kX_WE, moved, 0.011, 1e-6));
  EXPECT_FALSE(are_near(kX_WE, moved, 0.009, 1e-6));
  math::Pose turned = kX_WE;
  turned.linear() *= math::exp_rotation({0, 0.1, 0});
  EXPECT_TRUE(are_near(kX_WE, turned, 1e-6, 0.101));
  EXPECT_FALSE(are_near(kX_WE, turned, 1e-6, 0.099));
  turned.linear() = kX_WE.linear() * math::exp_rotation({0, math::kPi, 0});
  EXPECT_FALSE(are_near(kX_WE, turned, 1e-6, 1));
}

}  // namespace
}  // namespace palpate::frames
