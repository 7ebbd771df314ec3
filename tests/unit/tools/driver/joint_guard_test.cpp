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

class SmoothGuard : public ::testing::Test {
 protected:
  static JointGuard::Options options() {
    JointGuard::Options options;
    options.jerk = 50;
    return options;
  }
  static Command joints(double speed) {
    Command command;
    command.kind = Command::Kind::kJoints;
    command.dq = Joints::Constant(7, speed);
    return command;
  }
  JointGuard guard_{chain(), options()}, plain_{chain(), {}};
  const Joints q_ = bent(7);
};

TEST_F(SmoothGuard, SpeedsUpByTheSCurveOfItsLimits) {
  // 0.6 / 5 + 5 / 50 s
  double v = 0, a = 0, jerk = 0, acceleration = 0;
  int cycles = 0;
  while (v < 0.6 - 1e-12 && cycles < 1000) {
    const double next = guard_.limit(joints(0.6), q_)[2];
    ASSERT_LE(next, 0.6 + 1e-12);
    jerk = std::max(jerk, std::abs((next - v) / 1e-3 - a) / 1e-3);
    a = (next - v) / 1e-3;
    acceleration = std::max(acceleration, a);
    v = next;
    ++cycles;
  }
  EXPECT_NEAR(cycles * 1e-3, 0.22, 2e-3);
  EXPECT_LE(jerk, 50 * (1 + 1e-6));
  EXPECT_NEAR(acceleration, 5, 1e-6);
}

TEST_F(SmoothGuard, DelaysNoStopAndIsNeverFasterThanWithoutAJerkLimit) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> number(-0.8, 0.8);
  Command command = joints(0), stop;
  stop.kind = Command::Kind::kStop;
  double before = 0, gained = 0;
  for (int i = 0; i < 20000; ++i) {
    if (i % 73 == 0) command = joints(number(random));
    const bool stops = i % 500 > 350;
    const Command& now = stops ? stop : command;
    const double plain = plain_.limit(now, q_)[0], smooth = guard_.limit(now, q_)[0];
    const double a = (smooth - before) / 1e-3;
    ASSERT_LE(std::abs(a), 5 * (1 + 1e-9));
    const bool speeds_up = std::abs(smooth) > std::abs(before);
    if (speeds_up) {
      ASSERT_LE(std::abs(a) - gained, 50 * 1e-3 * (1 + 1e-6)) << i;
    }
    gained = speeds_up ? std::abs(a) : 0;
    if (stops && i % 500 > 351) {
      const double braked = std::max(0.0, std::abs(before) - 5e-3);
      ASSERT_NEAR(std::abs(smooth), braked, 1e-12) << "the stop without a jerk limit";
    }
    before = smooth;
    static_cast<void>(plain);
  }
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
