#include "tools/bridge/franka/franka.hpp"

#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>

#include "tests/unit/tools/bridge/franka/cell.hpp"

namespace palpate::franka_bridge {
namespace {

constexpr double kStill = 2e-3;  // rad/s
constexpr double kSpeed = 0.25;  // rad/s

TEST(Franka, SendsNothingBeforePalpatedMovesTheArm) {
  Cell cell;
  cell.rest();
  cell.run(500);
  EXPECT_GT(cell.states, 200);
  EXPECT_EQ(cell.mock.commands(), 0);
  EXPECT_EQ(cell.mock.motions(), 0);
  EXPECT_EQ(cell.mock.q(), Cell::bent());
  cell.move(kSpeed);
  cell.run(100);
  EXPECT_EQ(cell.mock.motions(), 1);
  EXPECT_GT(cell.mock.speed(), 0.9 * kSpeed);
}

TEST(Franka, MovesAsCommandedAndReportsTheArm) {
  Cell cell;
  cell.mock.tau_J = {1, -2, 3, 0, 0, 0.5, 0};
  cell.start(0.2);
  const driver::Joints before = cell.mock.q();
  const int commands = cell.mock.commands();
  cell.run(500);
  const driver::Joints way = cell.mock.q() - before;
  EXPECT_NEAR(way.minCoeff(), 0.1, 1e-3);
  EXPECT_NEAR(way.maxCoeff(), 0.1, 1e-3);
  EXPECT_EQ(cell.mock.commands() - commands, 500) << "one for each state";
  EXPECT_NEAR(cell.state.q[4], cell.mock.q()[4], 1e-3);
  EXPECT_NEAR(cell.state.dq[4], 0.2, 1e-3);
  EXPECT_FLOAT_EQ(static_cast<float>(cell.state.tau[1]), -2);
  EXPECT_EQ(cell.mock.violation(), "");
  EXPECT_EQ(cell.mock.reflexes(), 0);
}

TEST(Franka, ReportsExternalTorquesIfWanted) {
  Cell cell(Cell::bent(), [](auto& options) { options.torque = Franka::Torque::kExternal; });
  cell.mock.tau_J = {1, 1, 1, 1, 1, 1, 1};
  cell.mock.tau_ext = {0, 0.25, 0, 0, 0, 0, 0};
  cell.run(50);
  EXPECT_EQ(cell.state.tau[0], 0);
  EXPECT_EQ(cell.state.tau[1], 0.25);
}

TEST(Franka, EndsAMotionAtRestAndBeginsAnother) {
  Cell cell;
  cell.start(kSpeed);
  cell.rest();
  cell.run(1900);
  EXPECT_EQ(cell.mock.ended(), 0);
  cell.run(300);
  EXPECT_EQ(cell.mock.ended(), 1);
  EXPECT_EQ(cell.mock.mode(), RobotMode::kIdle);
  cell.move(kSpeed);
  cell.run(100);
  EXPECT_EQ(cell.mock.motions(), 2);
  EXPECT_GT(cell.mock.speed(), 0.9 * kSpeed);
  EXPECT_EQ(cell.mock.violation(), "");
}

TEST(Franka, StopsWithPalpated) {
  Cell cell;
  cell.start(kSpeed);
  cell.is_palpated_dead = true;
  cell.run(180);  // the watchdog's 100 ms, 50 ms of slowing down, and the way
  EXPECT_LT(cell.mock.speed(), kStill);
  EXPECT_EQ(cell.mock.reflexes(), 0);
}

/// The arm extrapolates over what is lost; the limits of acceleration and jerk hold nevertheless.
TEST(Franka, LostStatesAndCommandsAreNoReflex) {
  Cell cell;
  cell.start(0);
  int cycle = 0;
  cell.each = [&] {
    auto& states = cell.mock.network().to_client;
    if (++cycle % 7 == 0 && !states.empty()) states.pop_back();
    cell.mock.is_deaf = cycle % 11 == 0;  // to the next command
  };
  for (int i = 0; i < 8; ++i) {
    cell.move(i % 2 == 0 ? kSpeed : -kSpeed);
    cell.run(250);
  }
  EXPECT_EQ(cell.mock.reflexes(), 0);
  EXPECT_GT(cell.mock.speed(), 0.9 * kSpeed);
  EXPECT_GT(cell.franka->counts().lost, 50);
}

/// Two states in one cycle, none in the next.
TEST(Franka, AMachineThatIsLateIsNoReflex) {
  Cell cell;
  cell.start(kSpeed);
  int cycle = 0;
  cell.each = [&] { cell.mock.delay_ns = ++cycle / 10 % 2 == 0 ? 0 : 600'000; };
  cell.run(300);
  cell.move(-kSpeed);
  cell.run(300);
  EXPECT_EQ(cell.mock.reflexes(), 0);
  EXPECT_GT(cell.mock.speed(), 0.9 * kSpeed);
}

/// Answers to late states are late themselves, and the arm drops them.
TEST(Franka, StatesThatArriveLaterAndLaterStopTheArm) {
  Cell cell;
  cell.start(kSpeed);
  // Without a gap that would be noticed: 0.1 ms more in each ms.
  cell.each = [&cell] { cell.mock.delay_ns += 100'000; };
  cell.run(120);
  EXPECT_EQ(cell.mock.reflexes(), 1);
  EXPECT_LT(cell.mock.speed(), kStill);
}

TEST(Franka, NamesWhatIsWrong) {
  const auto said = [](const std::function<void(MockArm&)>& change, const char* text) {
    Cell cell;
    change(cell.mock);
    cell.move(kSpeed);
    cell.run(2000);
    EXPECT_EQ(cell.states, 0) << text;
    EXPECT_EQ(cell.mock.motions(), 0);
    EXPECT_TRUE(cell.has_said(text)) << text;
  };
  said([](auto& mock) { mock.version = 9; }, "has version 9 of the FCI; allowed: 10");
  said([](auto& mock) { mock.is_cut_short = true; }, "a state of 1376 bytes; allowed: 1377");
  Cell cell;
  cell.mock.refuses_moves = 6;
  testing::internal::CaptureStderr();
  cell.start(kSpeed);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("the arm has ended the motion: rests"),
            std::string::npos);
  EXPECT_TRUE(cell.has_said("the motion: rejected: the arm is at a singular pose"));
  cell.run(1000);
  EXPECT_EQ(cell.mock.motions(), 0);
  EXPECT_EQ(cell.franka->motions(), 1) << "not asked for again by itself";
}

/// The motion is longer than the braking distance to the end of joint 4.
TEST(Franka, SlowsDownBeforeTheEndOfAJoint) {
  driver::Joints q = Cell::bent(), dq = driver::Joints::Zero(kJoints);
  q[3] = -0.6;
  dq[3] = 1.2;
  Cell cell(q);
  cell.rest();
  cell.run(300);
  cell.move(dq);
  cell.run(3000);
  EXPECT_EQ(cell.mock.reflexes(), 0);
  EXPECT_GT(cell.mock.q()[3], -0.25);
  EXPECT_LT(cell.mock.q()[3], -0.1458);
}

TEST(Franka, AReflexIsLeftOnlyIfThatIsWanted) {
  for (const bool recovers : {false, true}) {
    Cell cell(Cell::bent(), [&](auto& options) { options.recovers = recovers; });
    cell.start(kSpeed);
    cell.mock.collide();
    cell.run(500);
    EXPECT_EQ(cell.mock.mode(), RobotMode::kReflex);
    EXPECT_TRUE(cell.has_said("reflex of the arm: joint_reflex"));
    const driver::Joints stood = cell.mock.q();
    cell.run(1000);
    EXPECT_EQ(cell.mock.mode(), recovers ? RobotMode::kIdle : RobotMode::kReflex);
    EXPECT_LT((cell.mock.q() - stood).norm(), 1e-4) << "rests until palpated is stopped";
    EXPECT_EQ(cell.mock.motions(), 1);
    cell.rest();
    cell.run(20);
    cell.move(kSpeed);
    cell.run(100);
    EXPECT_EQ(cell.mock.speed() > 0.9 * kSpeed, recovers);
  }
}

/// The end effector is turned by a quarter about z of the flange and 0.1 m in front of it; K
/// another about x of the end effector.
TEST(Franka, TheExternalWrenchIsInTheAxesOfTheFlangeAndAboutIt) {
  Cell cell(Cell::bent(), [](auto& options) { options.wrench = Franka::ExternalWrench{-1, 0.73}; });
  cell.mock.X_FE = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0.1, 1};
  cell.mock.X_EK = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1};
  cell.mock.F_K = {1, 2, 3, 0.25, 0.5, 0.75};
  cell.mock.end_effector = 0.73;
  bus::TypedSubscription<ft_wrench_t> wrenches(*cell.peer, "FT_WRENCH", 1000);
  cell.run(100);
  ft_wrench_t wrench{};
  std::int64_t arrival_ns = 0;
  int count = 0;
  while (wrenches.take(wrench, arrival_ns)) ++count;
  EXPECT_NEAR(count, 98, 4) << "one for each state";
  // In F: the force on the hand (3, 1, 2), the torque about K (0.75, 0.25, 0.5).
  const double expected[6] = {-3, -1, -2, -0.75 + 0.1, -0.25 - 0.3, -0.5};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(wrench.wrench[i], expected[i], 1e-6) << i;
  // A load that has been changed in Desk.
  cell.mock.load = 1;
  cell.run(10);
  while (wrenches.take(wrench, arrival_ns)) {
  }
  cell.run(100);
  EXPECT_FALSE(wrenches.take(wrench, arrival_ns));
  EXPECT_TRUE(cell.has_said("subtracts a payload of 1.73"));
}

}  // namespace
}  // namespace palpate::franka_bridge
