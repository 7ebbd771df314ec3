#include "core/estimation/rest_detector.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::estimation {
namespace {

constexpr double kDt = 1e-3;

class RestDetectorTest : public ::testing::Test {
 protected:
  void run(double seconds, int count = 1) {
    for (int i = 0; i < std::lround(seconds / kDt); ++i) rest_.update(grasps_, count, kDt);
  }

  RestDetector rest_{RestDetector::Options()};
  std::array<GraspInput, 2> grasps_;
};

TEST_F(RestDetectorTest, TimeAccumulatesWhileTheHandRests) {
  run(0.29);
  EXPECT_NEAR(rest_.rest_time(), 0.29, 1e-9);
  EXPECT_FALSE(rest_.is_at_rest());
  run(0.02);
  EXPECT_TRUE(rest_.is_at_rest());
}

TEST_F(RestDetectorTest, LeavingTheRestPoseIsMotion) {
  run(0.5);
  grasps_[0].X_OG.translation().x() = 4e-4;
  rest_.update(grasps_, 1, kDt);
  EXPECT_EQ(rest_.rest_time(), 0);
  run(0.1);  // the present pose is the new rest pose
  EXPECT_NEAR(rest_.rest_time(), 0.1, 1e-9);
}

TEST_F(RestDetectorTest, RotationIsMotion) {
  run(0.5);
  grasps_[0].X_OG.linear() = math::exp_rotation({0, 4e-3, 0});
  rest_.update(grasps_, 1, kDt);
  EXPECT_EQ(rest_.rest_time(), 0);
}

TEST_F(RestDetectorTest, ASmallStepIsMotionUntilItIsNoLongerRecent) {
  run(0.5);
  grasps_[0].X_OG.translation().x() = 1e-4;  // within the distance of a resting hand
  rest_.update(grasps_, 1, kDt);
  EXPECT_EQ(rest_.rest_time(), 0);
  run(0.5);  // its mean over 0.1 s follows
  EXPECT_GT(rest_.rest_time(), 0.4);
}

TEST_F(RestDetectorTest, OneMovingHandOfTwoIsEnough) {
  run(0.5, 2);
  grasps_[1].X_OG.translation().z() = 1e-3;
  rest_.update(grasps_, 2, kDt);
  EXPECT_EQ(rest_.rest_time(), 0);
}

TEST_F(RestDetectorTest, PosesThatAreNotFiniteAreIgnored) {
  run(0.5);
  grasps_[0].X_OG.translation().x() = std::numeric_limits<double>::quiet_NaN();
  run(0.1);
  EXPECT_NEAR(rest_.rest_time(), 0.6, 1e-9);
}

TEST_F(RestDetectorTest, AReleasedHandHasNoRestPose) {
  grasps_[0].X_OG.translation().x() = 0.3;
  run(0.5);
  rest_.release(0);
  rest_.update(grasps_, 1, kDt);
  EXPECT_EQ(rest_.rest_time(), 0);
}

TEST_F(RestDetectorTest, ResetForgetsTheTime) {
  run(0.5);
  rest_.reset();
  EXPECT_EQ(rest_.rest_time(), 0);
}

}  // namespace
}  // namespace palpate::estimation
