// Obstacles carried by links and moved by messages, against motions in closed form.
#include "rt/pipeline/obstacle_motion.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "rt/bus/text.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/support/pipeline_cycles.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::pipeline {
namespace {

using Eigen::Vector3d;

const math::Pose kObject = math::make_pose(math::exp_rotation({0, 0, M_PI}), {1.36, 0.03, 0.28});

/// Two joints about z, 0.4 m apart, and a link of 0.3 m.
const char* const kPlanarArm = R"(<robot name="planar">
  <link name="base"/> <link name="upper"/> <link name="lower"/> <link name="flange"/>
  <joint name="shoulder" type="revolute"> <parent link="base"/> <child link="upper"/>
    <axis xyz="0 0 1"/> <limit lower="-3" upper="3" velocity="2" effort="1"/> </joint>
  <joint name="elbow" type="revolute"> <origin xyz="0.4 0 0"/> <parent link="upper"/>
    <child link="lower"/> <axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="2" effort="1"/> </joint>
  <joint name="end" type="fixed"> <origin xyz="0.3 0 0"/> <parent link="lower"/>
    <child link="flange"/> </joint>
</robot>)";

class ObstacleMotionTest : public ::testing::Test {
 protected:
  ObstacleMotion motion(const std::string& list) {
    std::ofstream(folder_.path() / "arm.urdf") << kPlanarArm;
    return {registry::read_obstacles(
                config::Node::from_text("robot: {urdf: " + (folder_.path() / "arm.urdf").string() +
                                        "}\nobstacles:\n" + list),
                kObject),
            kObject};
  }

  /// `X_WB` and `V_W_B` of an obstacle in the next tick.
  void say(const char* name, const math::Pose& X_WB, const math::Twist& V_W_B) {
    sensing::ObstacleState& state = signals_.world.fresh[signals_.world.fresh_count++];
    bus::put_text(state.name, name);
    state.X_WB = X_WB;
    state.V_W_B = V_W_B;
  }
  static math::Pose in_W(const collision::Placement& placement) { return kObject * placement.X_OB; }

  support::ScratchFolder folder_;
  sensing::Signals signals_;
};

TEST_F(ObstacleMotionTest, ALinkCarriesItsObstacles) {
  ObstacleMotion motion = this->motion(
      "  - {name: fixed, shape: sphere, radius: 0.1, pose: {position: [1, 2, 3]}}\n"
      "  - {name: elbow, shape: sphere, radius: 0.1, link: lower, pose: {position: [0.1, 0.2, "
      "0]}}\n"
      "  - {name: shoulder, shape: sphere, radius: 0.1, link: upper}\n");
  const double q[] = {0.3, -0.7}, dq[] = {0.5, 0.9};
  signals_.robot.latest.joint_count = 2;
  signals_.robot.latest.q.head<2>() << q[0], q[1];
  signals_.robot.latest.dq.head<2>() << dq[0], dq[1];
  EXPECT_EQ(motion.update(signals_, false).status, Status::kDegraded);
  EXPECT_STREQ(motion.late(), "elbow");
  EXPECT_FALSE(motion.placements()[1].is_known) << "the joints are not known yet";

  EXPECT_TRUE(motion.update(signals_, true).is_ok());
  EXPECT_STREQ(motion.late(), "");
  const collision::Placement& fixed = motion.placements()[0];
  EXPECT_LT((in_W(fixed).translation() - Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_EQ(fixed.V_O_B.vector().norm(), 0);

  const collision::Placement& elbow = motion.placements()[1];
  const double turn = q[0] + q[1];
  const Vector3d joint(0.4 * std::cos(q[0]), 0.4 * std::sin(q[0]), 0);
  const Vector3d arm(0.1 * std::cos(turn) - 0.2 * std::sin(turn),
                     0.1 * std::sin(turn) + 0.2 * std::cos(turn), 0);
  const math::Pose expected = math::make_pose(math::exp_rotation({0, 0, turn}), joint + arm);
  EXPECT_LT((in_W(elbow).matrix() - expected.matrix()).norm(), 1e-12);
  const Vector3d up = Vector3d::UnitZ();
  const Vector3d velocity = dq[0] * up.cross(joint) + (dq[0] + dq[1]) * up.cross(arm);
  EXPECT_LT((kObject.linear() * elbow.V_O_B.linear - velocity).norm(), 1e-12);
  EXPECT_LT((kObject.linear() * elbow.V_O_B.angular - (dq[0] + dq[1]) * up).norm(), 1e-12);
  EXPECT_LT((in_W(motion.placements()[2]).matrix() -
             math::make_pose(math::exp_rotation({0, 0, q[0]}), Vector3d::Zero()).matrix())
                .norm(),
            1e-12);

  const math::Pose last = elbow.X_OB;
  signals_.robot.latest.q[0] = 1;
  EXPECT_EQ(motion.update(signals_, false).status, Status::kDegraded);
  EXPECT_EQ(elbow.X_OB.matrix(), last.matrix()) << "stays";
  EXPECT_EQ(elbow.V_O_B.vector().norm(), 0);
}

TEST_F(ObstacleMotionTest, AnEstimateDisplacesObstaclesInTheirOwnFrames) {
  ObstacleMotion motion = this->motion(
      "  - {name: fixed, shape: sphere, radius: 0.1, pose: {position: [1, 2, 3]}}\n"
      "  - {name: table, shape: half_space, pose: {position: [0, 0, 1], rpy_deg: [90, 0, 0]}, "
      "pose_deviation: {position: [0, 0, 0.01], rotation_deg: [1, 0, 0]}}\n"
      "  - {name: lower, shape: sphere, radius: 0.1, link: lower, pose_deviation: {position: "
      "[0.01, 0, 0]}}\n");
  ASSERT_EQ(motion.free_directions().size(), 3u);
  signals_.robot.latest.joint_count = 2;
  for (int i = 0; i < 2; ++i) {  // it does not add up
    EXPECT_TRUE(motion.update(signals_, true, {0.002, 0.1, 0.003}).is_ok());
    EXPECT_LT((motion.X_WB(0).translation() - Vector3d(1, 2, 3)).norm(), 1e-12);
    const math::Pose table = motion.X_WB(1);
    EXPECT_LT((table.translation() - Vector3d(0, -0.002, 1)).norm(), 1e-12) << "z of its frame";
    EXPECT_LT((table.linear() - math::exp_rotation({M_PI / 2 + 0.1, 0, 0})).norm(), 1e-12);
    EXPECT_LT((motion.X_WB(2).translation() - Vector3d(0.403, 0, 0)).norm(), 1e-12);
    EXPECT_LT((in_W(motion.placements()[1]).matrix() - table.matrix()).norm(), 1e-12);
  }
}

TEST_F(ObstacleMotionTest, MessagesMoveAnObstacleWhichKeepsItsVelocityForATime) {
  ObstacleMotion motion = this->motion(
      "  - {name: lid, shape: sphere, radius: 0.1, moved: true, timeout_ms: 50}\n"
      "  - {name: tray, shape: sphere, radius: 0.1, moved: true, pose: {position: [0, 0, 1]}}\n");
  EXPECT_EQ(motion.moved(), (std::vector<std::string>{"lid", "tray"}));
  UpdateResult result = motion.update(signals_, false);
  EXPECT_EQ(result.status, Status::kDegraded);
  EXPECT_STREQ(motion.late(), "lid");
  EXPECT_STREQ(result.reason, "no message has moved this obstacle yet");
  EXPECT_FALSE(motion.placements()[0].is_known);
  EXPECT_TRUE(motion.placements()[1].is_known) << "it has a pose";

  const math::Twist twist{{0.1, -0.2, 0.3}, {0, 0, 2}};
  say("lid", math::make_pose(math::exp_rotation({0, 0, 0.5}), {1, 0, 0}), twist);
  say("tray", math::Pose::Identity(), {});
  const loop::NoAllocationScope scope;
  EXPECT_TRUE(motion.update(signals_, false).is_ok());
  signals_.world.fresh_count = 0;
  const collision::Placement& lid = motion.placements()[0];
  EXPECT_TRUE(lid.is_known);
  int ticks = 0;
  while (motion.update(signals_, false).is_ok()) ++ticks;
  EXPECT_EQ(scope.count(), 0);
  EXPECT_NEAR(ticks, 50, 1);
  const double t = 1e-3 * ticks;
  const math::Pose expected = math::make_pose(math::exp_rotation({0, 0, 0.5 + 2 * t}),
                                              Vector3d(1, 0, 0) + t * twist.linear);
  EXPECT_LT((in_W(lid).matrix() - expected.matrix()).norm(), 1e-12);
  EXPECT_STREQ(motion.late(), "lid");
  EXPECT_EQ(lid.V_O_B.vector().norm(), 0);
  const math::Pose last = lid.X_OB;
  result = motion.update(signals_, false);
  EXPECT_STREQ(result.reason, "no message moves this obstacle any more");
  EXPECT_EQ(lid.X_OB.matrix(), last.matrix());

  say("lid", math::Pose::Identity(), {});  // the older one of a tick does not count
  say("lid", math::make_pose(Eigen::Matrix3d::Identity(), {0, 0, 2}), {});
  say("tray", math::Pose::Identity(), {});
  EXPECT_TRUE(motion.update(signals_, false).is_ok());
  EXPECT_LT((in_W(lid).translation() - Vector3d(0, 0, 2)).norm(), 1e-12);
}

/// While the place of an obstacle is unknown, the pipeline is degraded and the arm rests.
TEST(ObstaclesOfAPipeline, UnknownPlacesStopTheArm) {
  const config::Node root = config::Node::load_file(
      PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft_limits.yaml",
      {"sensing=[]",
       "obstacles=[{name: lid, shape: sphere, radius: 0.1, moved: true, pose: {position: [0, 0, "
       "3]}}]"});
  Pipeline pipeline(root, 1e-3);
  sensing::Signals signals = support::at_rest(pipeline);
  const auto cycles = [&](int count, bool is_seen) {
    for (int i = 0; i < count; ++i) {
      signals.world.fresh_count = is_seen ? 1 : 0;
      support::run(pipeline, signals, 1);
    }
  };
  sensing::ObstacleState& lid = signals.world.fresh[0];
  bus::put_text(lid.name, "lid");
  lid.X_WB.translation() << 0, 0, 3;
  pipeline.start();
  cycles(50, true);
  Eigen::Vector3d target = pipeline.feature_state().value;
  target.z() += 0.02;
  const char* reason = "";
  ASSERT_TRUE(pipeline.set_target(1, "point", nullptr, 0, target.data(), 3, reason)) << reason;
  cycles(50, true);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kActive) << pipeline.condition().reason;
  EXPECT_GT(pipeline.gate_output(0).V_W_E.linear.norm(), 1e-3);
  cycles(200, false);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kDegraded);
  EXPECT_STREQ(pipeline.condition().component, "lid");
  EXPECT_STREQ(pipeline.condition().reason, "no message moves this obstacle any more");
  EXPECT_EQ(pipeline.gate_output(0).V_W_E.vector().norm(), 0);
  cycles(50, true);
  EXPECT_EQ(pipeline.condition().state, LifeCycle::kActive);
  EXPECT_GT(pipeline.gate_output(0).V_W_E.linear.norm(), 1e-3);
}

}  // namespace
}  // namespace palpate::pipeline
