#include "tools/driver/joint_guard.hpp"

#include <gtest/gtest.h>

#include <random>

#include "rt/registry/arm_model.hpp"
#include "tools/driver/simulated_arm.hpp"

namespace palpate::driver {
namespace {

kinematics::SerialChain chain() {
  return registry::read_urdf(std::string(PALPATE_SOURCE_DIR) + "/sim/robot/lwr_hand.urdf",
                             "flange");
}

Joints bent(int count) {
  Joints q = Joints::Constant(count, 0.5);
  q[3] = -1.2;
  return q;
}

Command twist(const Eigen::Vector3d& linear) {
  Command command;
  command.kind = Command::Kind::kTwist;
  command.V_W_E.linear = linear;
  return command;
}

/// After enough cycles to reach any speed.
Joints settled(JointGuard& guard, const Command& command, const Joints& q) {
  for (int i = 0; i < 2000; ++i) guard.limit(command, q);
  return guard.limit(command, q);
}

TEST(JointGuard, MovesTheFlangeAsCommanded) {
  JointGuard guard(chain(), {});
  const Joints q = bent(7);
  const Joints dq = settled(guard, twist({0.03, -0.02, 0.05}), q);
  kinematics::SerialChain::State state;
  chain().evaluate(q, state);
  const math::Vector6d V = state.J_W_E * dq;
  EXPECT_LT((V.head<3>() - Eigen::Vector3d(0.03, -0.02, 0.05)).norm(), 2e-3);
  EXPECT_LT(V.tail<3>().norm(), 5e-3);
}

TEST(JointGuard, TooFastATwistIsSlowerInTheSameDirection) {
  JointGuard guard(chain(), {});
  const Joints q = bent(7);
  kinematics::SerialChain::State state;
  chain().evaluate(q, state);
  const Joints dq = settled(guard, twist({0, 0, 1e200}), q);
  const Eigen::Vector3d v = (state.J_W_E * dq).head<3>();
  EXPECT_LE(v.norm(), 0.25 * 1.001);
  EXPECT_GT(v.normalized().z(), 0.99);
}

/// For any command of any duration, no limit is exceeded.
TEST(JointGuard, KeepsEveryLimit) {
  const kinematics::SerialChain arm = chain();
  const JointGuard::Options options;
  JointGuard guard(arm, options);
  Joints q = bent(7), before = Joints::Zero(7);
  std::mt19937 random(1);
  std::normal_distribution<double> number(0, 3);
  Command command;
  command.kind = Command::Kind::kJoints;
  command.dq.setZero(7);
  for (int i = 0; i < 20000; ++i) {
    if (i % 500 == 0)
      for (int j = 0; j < 7; ++j) command.dq[j] = number(random);
    const Joints dq = guard.limit(command, q);
    for (int j = 0; j < 7; ++j) {
      ASSERT_LE(std::abs(dq[j]), options.speed_share * arm.joint(j).speed + 1e-9);
      ASSERT_LE(std::abs(dq[j] - before[j]), options.acceleration * options.period + 1e-9);
      ASSERT_GE(q[j], arm.joint(j).lower);
      ASSERT_LE(q[j], arm.joint(j).upper);
    }
    before = dq;
    q += options.period * dq;
  }
}

TEST(JointGuard, AStopComesToRest) {
  JointGuard guard(chain(), {});
  settled(guard, twist({0.2, 0, 0}), bent(7));
  EXPECT_TRUE(settled(guard, Command(), bent(7)).isZero(0));
}

TEST(SimulatedArm, WeighsItsHandAndObeysItsButton) {
  SimulatedArm::Options options;
  options.q = bent(7);
  double now = 0;  // s
  options.clock = [&now] { return now += 1e-3; };
  SimulatedArm arm(chain(), options);
  ArmState state;
  ASSERT_TRUE(arm.read(state));
  EXPECT_NEAR(state.wrench_S.force.norm(), 9.81 * 4.8, 0.3);
  kinematics::SerialChain::State pose;
  chain().evaluate(state.q, pose);
  EXPECT_GT((pose.X_WE.linear() * state.wrench_S.force).z(), 46) << "it holds the hand up";
  const Joints dq = Joints::Constant(7, 0.1);
  for (int i = 0; i < 500; ++i) arm.command(dq);
  arm.read(state);
  EXPECT_NEAR(state.dq[0], 0.1, 1e-3);
  arm.press_stop(true);
  for (int i = 0; i < 500; ++i) arm.command(dq);
  arm.read(state);
  EXPECT_TRUE(state.stopped);
  EXPECT_TRUE(state.dq.isZero(0));
}

TEST(SimulatedArm, MovesOnWhileACycleIsLate) {
  SimulatedArm::Options options;
  options.q = bent(7);
  double now = 0;  // s
  options.clock = [&now] { return now; };
  SimulatedArm arm(chain(), options);
  const Joints dq = Joints::Constant(7, 0.1);
  for (int i = 0; i < 200; ++i, now += 1e-3) arm.command(dq);
  ArmState before, after;
  arm.read(before);
  now += 0.02;
  arm.command(dq);
  arm.read(after);
  EXPECT_NEAR(after.q[0] - before.q[0], 0.1 * 0.021, 1e-6);
}

}  // namespace
}  // namespace palpate::driver
