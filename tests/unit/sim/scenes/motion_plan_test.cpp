#include "sim/scenes/motion_plan.hpp"

#include <gtest/gtest.h>

namespace palpate::scenes {
namespace {

MotionPlan plan() {
  return MotionPlan({{2, 1, {0, 0, -0.08}, {0, 0, 0}},
                     {1.5, 0.5, {0.02, 0.12, 0}, {0.3, -0.4, 0.5}},
                     {2, 0, {-0.05, 0.1, 0.1}, {0, 0.6, 0}}},
                    1);
}

TEST(MotionPlan, StandsStillBeforeBetweenAndAfter) {
  const MotionPlan p = plan();
  EXPECT_DOUBLE_EQ(p.duration(), 1 + 3 + 2 + 2);
  for (double t : {0.0, 0.5, 1.0}) {
    EXPECT_EQ(p.at(t).translation, Eigen::Vector3d::Zero());
    EXPECT_EQ(p.at(t).velocity.vector().norm(), 0);
  }
  for (double t : {3.0, 3.5, 4.0}) {
    EXPECT_TRUE(p.at(t).translation.isApprox(Eigen::Vector3d(0, 0, -0.08)));
    EXPECT_EQ(p.at(t).velocity.vector().norm(), 0);
  }
  for (double t : {8.0, 100.0}) {
    EXPECT_TRUE(p.at(t).translation.isApprox(Eigen::Vector3d(-0.05, 0.1, 0.1)));
    EXPECT_TRUE(p.at(t).rotation.isApprox(math::exp_rotation({0, 0.6, 0}), 1e-12));
    EXPECT_EQ(p.at(t).velocity.vector().norm(), 0);
  }
}

TEST(MotionPlan, VelocityIsTheDerivativeOfThePose) {
  const MotionPlan p = plan();
  const double h = 1e-5;
  for (double t = 0.01; t < 8; t += 0.0537) {
    const MotionPoint before = p.at(t - h), now = p.at(t), after = p.at(t + h);
    EXPECT_LT(((after.translation - before.translation) / (2 * h) - now.velocity.linear).norm(),
              1e-6);
    const Eigen::Vector3d turned =
        math::log_rotation(after.rotation * before.rotation.transpose()) / (2 * h);
    EXPECT_LT((turned - now.velocity.angular).norm(), 1e-6);
  }
}

TEST(MotionPlan, IsMinimumJerk) {
  // Peak speed of a minimum-jerk move is 15/8 of its mean, at half time.
  const MotionPlan p({{2, 0, {0.1, 0, 0}, {0, 0, 0}}}, 0);
  EXPECT_NEAR(p.at(1).velocity.linear.x(), 15.0 / 8 * 0.05, 1e-12);
  EXPECT_NEAR(p.at(1).translation.x(), 0.05, 1e-12);
  double peak = 0;
  for (double t = 0; t < 2; t += 0.01) peak = std::max(peak, p.at(t).velocity.linear.x());
  EXPECT_LE(peak, 15.0 / 8 * 0.05 + 1e-12);
}

}  // namespace
}  // namespace palpate::scenes
