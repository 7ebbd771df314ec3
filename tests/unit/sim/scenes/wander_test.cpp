#include "sim/scenes/motion_plan.hpp"

#include <gtest/gtest.h>

#include "sim/scenes/scene.hpp"

namespace palpate::scenes {
namespace {

WanderOptions options(std::uint64_t seed = 3) {
  WanderOptions options;
  options.duration = 20;
  options.rise = 3;
  options.seed = seed;
  options.shortest = 1.5;
  options.longest = 6;
  options.translation = {0.1, 0.05, 0};
  options.rotation = {1.2, 0.4, 0.8};
  return options;
}

TEST(Wander, BeginsAndEndsAtRest) {
  const Wander wander(options());
  for (const double t : {-1.0, 0.0, 20.0, 50.0}) {
    EXPECT_EQ(wander.at(t).translation, Eigen::Vector3d::Zero());
    EXPECT_EQ(wander.at(t).rotation, Eigen::Matrix3d::Identity());
    EXPECT_EQ(wander.at(t).velocity.vector().norm(), 0);
  }
  for (const double t : {1e-4, 20 - 1e-4}) EXPECT_LT(wander.at(t).velocity.vector().norm(), 1e-6);
}

TEST(Wander, VelocityIsTheDerivativeOfThePose) {
  const Wander wander(options());
  const double h = 1e-5;
  double fastest = 0;
  for (double t = 0.01; t < 20; t += 0.0537) {
    const MotionPoint before = wander.at(t - h), now = wander.at(t), after = wander.at(t + h);
    EXPECT_LT(((after.translation - before.translation) / (2 * h) - now.velocity.linear).norm(),
              1e-7);
    const Eigen::Vector3d turned =
        math::log_rotation(after.rotation * before.rotation.transpose()) / (2 * h);
    EXPECT_LT((turned - now.velocity.angular).norm(), 1e-6) << t;
    fastest = std::max(fastest, now.velocity.angular.norm());
  }
  EXPECT_GT(fastest, 0.5);
}

TEST(Wander, StaysWithinItsBoundsAndFollowsItsSeed) {
  const Wander wander(options()), same(options()), other(options(4));
  double far = 0, apart = 0;
  for (double t = 0; t < 20; t += 0.05) {
    const MotionPoint point = wander.at(t);
    EXPECT_LE(std::abs(point.translation.x()), 0.1);
    EXPECT_LE(std::abs(point.translation.y()), 0.05);
    EXPECT_EQ(point.translation.z(), 0);
    EXPECT_EQ(point.translation, same.at(t).translation);
    far = std::max(far, std::abs(point.translation.x()));
    apart = std::max(apart, (point.translation - other.at(t).translation).norm());
  }
  EXPECT_GT(far, 0.03);
  EXPECT_GT(apart, 0.03);
}

TEST(Wander, FollowsTheLastPoseOfAScenesMotion) {
  const std::string file = PALPATE_SOURCE_DIR "/sim/scenes/payload_slow.yaml";
  const Scene scene = read_scene(config::Node::load_file(
      file, {"motion.poses=[{move: 1, hold: 0.5, translation: [0, 0, 0.1]}]"}));
  const MotionPlan& plan = *scene.motion;
  EXPECT_DOUBLE_EQ(plan.duration(), 3 + 1.5 + 40);
  EXPECT_TRUE(plan.at(4.5).translation.isApprox(Eigen::Vector3d(0, 0, 0.1)));
  EXPECT_TRUE(plan.at(44.5).translation.isApprox(Eigen::Vector3d(0, 0, 0.1)));
  EXPECT_GT((plan.at(20).translation - Eigen::Vector3d(0, 0, 0.1)).norm(), 1e-3);
  EXPECT_THROW(read_scene(config::Node::load_file(file, {"motion.wander.periods=[5, 2]"})),
               config::Error);
}

}  // namespace
}  // namespace palpate::scenes
