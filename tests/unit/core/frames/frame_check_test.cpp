#include "core/frames/frame_check.hpp"

#include <gtest/gtest.h>

namespace palpate::frames {
namespace {

class FrameCheck : public ::testing::Test {
 protected:
  FrameCheck() {
    frames_.X_EI.linear() = math::exp_rotation({0.4, -1.2, 0.3});
    signals_.robot.age = signals_.inertial.age = 0;
    signals_.inertial.freshness = Freshness::kNew;
    signals_.robot.latest.X_WE.linear() = math::exp_rotation({-0.7, 0.2, 1.9});
    const Eigen::Matrix3d R_WI = signals_.robot.latest.X_WE.linear() * frames_.X_EI.linear();
    signals_.inertial.latest.acceleration_I = R_WI.transpose() * Eigen::Vector3d(0, 0, 9.81);
  }
  bool contradicts(bool known = true) const {
    return *frame_contradiction({frames_, signals_, known}) != '\0';
  }
  void turn_mounting(double angle) {
    // about an axis across the direction of gravity in I
    const Eigen::Vector3d axis = signals_.inertial.latest.acceleration_I.unitOrthogonal() * angle;
    frames_.X_EI.linear() *= math::exp_rotation(axis);
  }

  ArmFrames frames_;
  sensing::Signals signals_;
};

TEST_F(FrameCheck, GravityDistinguishesAWrongMountingFromARightOne) {
  EXPECT_FALSE(contradicts());
  turn_mounting(0.5);
  EXPECT_FALSE(contradicts()) << "below 30 degrees";
  turn_mounting(0.05);
  EXPECT_TRUE(contradicts());
  turn_mounting(1.0);
  EXPECT_TRUE(contradicts());
}

TEST_F(FrameCheck, SaysNothingWithoutTheNeededSignals) {
  turn_mounting(2);
  ASSERT_TRUE(contradicts());
  EXPECT_FALSE(contradicts(false)) << "the flange is unknown";
  const sensing::Signals before = signals_;
  signals_.inertial.freshness = Freshness::kNoData;
  EXPECT_FALSE(contradicts());
  signals_ = before;
  signals_.inertial.age = 1;
  EXPECT_FALSE(contradicts()) << "old";
  signals_ = before;
  signals_.robot.latest.V_W_E.linear.x() = 0.1;
  EXPECT_FALSE(contradicts()) << "the hand moves";
  signals_ = before;
  signals_.inertial.latest.acceleration_I *= 1.2;
  EXPECT_FALSE(contradicts()) << "the hand accelerates";
}

}  // namespace
}  // namespace palpate::frames
