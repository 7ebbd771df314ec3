#include "tools/bridge/common/bridged_arm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <palpate/ft_wrench_t.hpp>

#include "tests/unit/tools/bridge/drake/cell.hpp"

namespace palpate::drake_bridge {
namespace {

using Kind = MockDriver::Kind;

constexpr double kStill = 2e-3;  // rad/s
constexpr double kSpeed = 0.25;  // rad/s

class EveryDriver : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(DrakeArm, EveryDriver,
                         ::testing::Values(Kind::kIiwa, Kind::kPanda, Kind::kFormerPanda));

/// Palpated waits, then moves the arm.
void start(Cell& cell, double speed = kSpeed) {
  cell.rest();
  cell.run(280);
  cell.move(speed);
  cell.run(150);
  ASSERT_GT(cell.drake.speed(), 0.9 * speed);
  ASSERT_FALSE(cell.drake.gave_up());
}

TEST_P(EveryDriver, SendsNothingBeforePalpatedMovesTheArm) {
  Cell cell(GetParam());
  cell.rest();
  cell.run(400);
  EXPECT_EQ(cell.drake.received(), 0);
  EXPECT_EQ(cell.drake.q(), Cell::bent());
  cell.move(kSpeed);
  cell.run(50);
  EXPECT_GT(cell.drake.received(), 0);
}

TEST_P(EveryDriver, SendsNothingWithin250MsOfTheFirstStatus) {
  Cell cell(GetParam());
  cell.move(kSpeed);  // a palpated that was left running
  cell.run(600);
  EXPECT_EQ(cell.drake.received(), 0) << "it has to be stopped and started";
  cell.rest();
  cell.run(20);
  cell.move(kSpeed);
  cell.run(100);
  EXPECT_GT(cell.drake.received(), 0);
  EXPECT_FALSE(cell.drake.gave_up());
}

TEST_P(EveryDriver, DoesNotMoveTheArmShortlyBeforeTheEndOfThatTime) {
  Cell cell(GetParam());
  cell.rest();
  cell.run(200);
  cell.move(kSpeed);
  cell.run(400);
  EXPECT_EQ(cell.drake.received(), 0) << "it has to be stopped and started";
}

TEST_P(EveryDriver, MovesAsCommandedAndReportsTheArm) {
  Cell cell(GetParam());
  start(cell, 0.2);
  const driver::Joints before = cell.drake.q();
  cell.run(500);
  const driver::Joints way = cell.drake.q() - before;
  EXPECT_NEAR(way.minCoeff(), 0.1, 2e-3);
  EXPECT_NEAR(way.maxCoeff(), 0.1, 2e-3);
  EXPECT_NEAR(cell.state.q[4], cell.drake.q()[4], 2e-3);
  EXPECT_NEAR(cell.state.dq[4], 0.2, 2e-3);
  EXPECT_EQ(cell.state.tau[1], 20);
  EXPECT_NEAR(cell.state.twist[5], 0.2, 0.4);
}

TEST_P(EveryDriver, ReportsExternalTorquesWhereConfigured) {
  Cell cell(GetParam(), Cell::bent(), true);
  start(cell, 0.2);
  EXPECT_EQ(cell.state.tau[1], 3);
}

TEST_P(EveryDriver, PublishesEachStateOnce) {
  Cell cell(GetParam());
  cell.run(1000);
  EXPECT_NEAR(cell.states, GetParam() == Kind::kIiwa ? 200 : 500, 2);
}

TEST_P(EveryDriver, StopsWithPalpated) {
  Cell cell(GetParam());
  start(cell);
  cell.is_palpated_dead = true;
  cell.run(180);  // the watchdog's 100 ms, 50 ms of slowing down, and the arm's lag
  EXPECT_LT(cell.drake.speed(), kStill);
}

TEST_P(EveryDriver, RestsAfterAButtonUntilPalpatedIsStopped) {
  Cell cell(GetParam());
  start(cell);
  cell.drake.is_stopped = true;
  cell.run(500);
  const driver::Joints stood = cell.drake.q();
  cell.drake.is_stopped = false;
  cell.run(700);
  EXPECT_LT((cell.drake.q() - stood).norm(), 1e-6) << "neither motion nor a jump";
  EXPECT_LT(cell.drake.speed(), kStill);
  cell.rest();
  cell.run(20);
  cell.move(kSpeed);
  cell.run(100);
  EXPECT_GT(cell.drake.speed(), 0.9 * kSpeed);
}

TEST_P(EveryDriver, ARestartedDriverIsANewSessionAndWaitsForStart) {
  Cell cell(GetParam());
  start(cell);
  const std::int64_t session = cell.state.session;
  cell.drake.is_mute = true;
  cell.run(70);
  cell.drake.is_mute = false;
  cell.drake.restart();
  cell.run(20);
  EXPECT_NE(cell.state.session, session) << "palpated stops by itself";
  const driver::Joints stood = cell.drake.q();
  cell.run(600);
  EXPECT_LT((cell.drake.q() - stood).norm(), 1e-3);
  EXPECT_FALSE(cell.drake.gave_up());
  EXPECT_EQ(cell.arm->counts().absences, 1);
}

TEST_P(EveryDriver, ARestartedDriverIsNotMovedByAPalpatedThatHasNotStopped) {
  Cell cell(GetParam());
  start(cell);
  cell.move(0);
  cell.drake.is_mute = true;
  cell.run(70);
  cell.drake.is_mute = false;
  cell.drake.restart();
  cell.run(300);
  const std::int64_t received = cell.drake.received();
  cell.move(kSpeed);
  cell.run(200);
  EXPECT_EQ(cell.drake.received(), received);
}

TEST_P(EveryDriver, NamesATypeThatItRefuses) {
  Cell cell(GetParam());
  cell.drake.has_other_type = true;
  cell.run(100);
  EXPECT_EQ(cell.states, 0);
  EXPECT_TRUE(cell.has_said("_STATUS: messages of type 0x"));
  EXPECT_TRUE(cell.has_said("are refused; allowed: lcmt_"));
  EXPECT_EQ(cell.said.size(), 1u);
}

TEST_P(EveryDriver, AJumpedClockOfTheDriverIsNoCommand) {
  Cell cell(GetParam());
  start(cell);
  cell.now_ns += 40'000'000;  // the bridge has not been scheduled
  const driver::Joints before = cell.drake.q();
  cell.run(5);
  EXPECT_LT((cell.drake.q() - before).norm(), 0.01 * kSpeed * 3 + 0.02);
}

TEST(DrakeArm, AForgedCountIsNotDecoded) {
  Cell cell(Kind::kIiwa);
  start(cell);
  ::drake::lcmt_iiwa_status status{};
  status.utime = cell.now_ns;
  status.num_joints = Cell::kJoints;
  for (auto* one :
       {&status.joint_position_measured, &status.joint_velocity_estimated,
        &status.joint_position_commanded, &status.joint_position_ipo, &status.joint_torque_measured,
        &status.joint_torque_commanded, &status.joint_torque_external})
    one->resize(Cell::kJoints, 1);
  std::vector<std::uint8_t> data(status.getEncodedSize());
  status.encode(data.data(), 0, static_cast<int>(data.size()));
  for (const int count : {-1, 0x7fffffff, 6, 8}) {
    for (int i = 0; i < 4; ++i)
      data[kJointsOffset + i] =
          static_cast<std::uint8_t>(static_cast<std::uint32_t>(count) >> (24 - 8 * i));
    cell.peer->publish("IIWA_STATUS", data.data(), static_cast<int>(data.size()));
  }
  cell.run(20);
  EXPECT_LT(
      (Eigen::Map<const Eigen::VectorXd>(cell.state.q, Cell::kJoints) - cell.drake.q()).norm(),
      0.01);
  EXPECT_GT(cell.drake.speed(), 0.9 * kSpeed);
}

TEST(DrakeArm, NamesAnArmWithOtherJoints) {
  Cell cell(Kind::kIiwa);
  ::drake::lcmt_iiwa_status status{};
  bus::TypedPublisher<::drake::lcmt_iiwa_status>(*cell.peer, "IIWA_STATUS").publish(status);
  cell.run(10);
  EXPECT_TRUE(cell.has_said("another number of joints"));
  EXPECT_TRUE(cell.has_said("with 7 joints"));
}

TEST(DrakeArm, AnIiwaAtRestHoldsItsTarget) {
  Cell cell(Kind::kIiwa);
  start(cell);
  cell.move(0);
  cell.run(200);
  const driver::Joints held = cell.drake.q();
  cell.run(1000);
  EXPECT_LT((cell.drake.q() - held).norm(), 1e-6);
}

TEST(DrakeArm, APandaInPositionModeIsNotMoved) {
  Cell cell(Kind::kPanda);
  cell.drake.control_mode = 1;
  cell.rest();
  cell.run(300);
  cell.move(kSpeed);
  cell.run(300);
  EXPECT_EQ(cell.drake.received(), 0);
}

TEST(DrakeArm, ASimulatedPandaNamesNoMode) {
  Cell cell(Kind::kPanda);
  cell.drake.control_mode = cell.drake.robot_mode = 0;
  start(cell);
}

TEST(DrakeArm, PublishesTheWrenchOnceForEachMessage) {
  Cell cell(Kind::kIiwa);
  cell.run(10);
  bus::TypedPublisher<::drake::lcmt_force_torque> wrist(*cell.peer, "WRIST");
  bus::TypedSubscription<ft_wrench_t> wrenches(*cell.peer, "FT_WRENCH", 1000);
  ::drake::lcmt_force_torque reading{};
  cell.each = [&, tick = 0]() mutable {
    reading.timestamp = ++tick;
    reading.fz = tick == 50 ? std::nan("") : 40 + 0.01 * tick;
    reading.ty = -2;
    if (tick % 4 == 0 || tick == 50) wrist.publish(reading);
  };
  cell.run(101);
  ft_wrench_t wrench;
  std::int64_t arrival_ns = 0;
  int count = 0;
  while (wrenches.take(wrench, arrival_ns)) ++count;
  EXPECT_EQ(count, 25);
  EXPECT_DOUBLE_EQ(wrench.wrench[2], 41);
  EXPECT_DOUBLE_EQ(wrench.wrench[4], -2);
}

}  // namespace
}  // namespace palpate::drake_bridge
