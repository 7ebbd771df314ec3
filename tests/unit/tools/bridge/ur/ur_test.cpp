#include "tools/bridge/ur/ur.hpp"

#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>

#include "tests/unit/tools/bridge/ur/cell.hpp"

namespace palpate::ur_bridge {
namespace {

constexpr double kStill = 2e-3;  // rad/s
constexpr double kSpeed = 0.25;  // rad/s

class EveryPeriod : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Ur, EveryPeriod, ::testing::Values(2, 8));

TEST_P(EveryPeriod, SendsNothingBeforePalpatedMovesTheArm) {
  Cell cell(GetParam());
  cell.rest();
  cell.run(500);
  EXPECT_GT(cell.states, 50);
  EXPECT_EQ(cell.controller.commands(), 0);
  EXPECT_EQ(cell.controller.programs(), 0);
  EXPECT_EQ(cell.controller.q(), Cell::bent());
  cell.move(kSpeed);
  cell.run(150);
  EXPECT_EQ(cell.controller.programs(), 1);
  EXPECT_GT(cell.controller.speed(), 0.9 * kSpeed);
}

TEST_P(EveryPeriod, MovesAsCommandedAndReportsTheArm) {
  Cell cell(GetParam());
  cell.start(0.2);
  const driver::Joints before = cell.controller.q();
  cell.run(500);
  const driver::Joints way = cell.controller.q() - before;
  EXPECT_NEAR(way.minCoeff(), 0.1, 2e-3);
  EXPECT_NEAR(way.maxCoeff(), 0.1, 2e-3);
  EXPECT_NEAR(cell.state.q[4], cell.controller.q()[4], 4e-3);
  EXPECT_NEAR(cell.state.dq[4], 0.2, 2e-3);
  EXPECT_EQ(cell.state.tau[1], 0);
  EXPECT_EQ(cell.controller.violation(), "");
  EXPECT_EQ(cell.controller.programs(), 1);
}

TEST_P(EveryPeriod, PublishesEachStateOnce) {
  Cell cell(GetParam());
  cell.run(100);
  const int before = cell.states;
  cell.run(1000);
  EXPECT_NEAR(cell.states - before, 1000 / GetParam(), 1);
}

TEST_P(EveryPeriod, StopsWithPalpated) {
  Cell cell(GetParam());
  cell.start(kSpeed);
  cell.is_palpated_dead = true;
  cell.run(180);  // the watchdog's 100 ms, 50 ms of slowing down, and the way
  EXPECT_LT(cell.controller.speed(), kStill);
  EXPECT_TRUE(cell.ur->is_program_running()) << "rests by commands";
}

TEST_P(EveryPeriod, AnOperatorsPauseIsAStop) {
  Cell cell(GetParam());
  cell.start(kSpeed);
  cell.controller.is_paused = true;
  cell.run(300);
  EXPECT_LT(cell.controller.speed(), kStill);
  cell.controller.is_paused = false;
  const driver::Joints stood = cell.controller.q();
  cell.run(300);
  EXPECT_LT((cell.controller.q() - stood).norm(), 1e-4) << "rests until palpated is stopped";
  cell.rest();
  cell.run(20);
  cell.move(kSpeed);
  cell.run(250);
  EXPECT_GT(cell.controller.speed(), 0.9 * kSpeed);
}

TEST_P(EveryPeriod, WhereAnotherProgramRunsNoneIsSent) {
  Cell cell(GetParam());
  cell.controller.run_other_program();
  cell.rest();
  cell.run(400);
  cell.move(kSpeed);
  cell.run(400);
  EXPECT_EQ(cell.controller.programs(), 0);
  EXPECT_TRUE(cell.has_said("another program commands the arm"));
}

TEST(Ur, AControllerThatTakesNoProgramsIsNamed) {
  Cell cell;
  cell.controller.is_remote = false;
  testing::internal::CaptureStderr();
  cell.start(kSpeed);
  cell.run(3100);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("remote control"), std::string::npos);
  EXPECT_EQ(cell.ur->programs(), 1) << "not sent again by itself";
}

TEST(Ur, StatesThatArriveLaterAndLaterAreRejected) {
  Cell cell;
  cell.start(kSpeed);
  // Without a gap that would be noticed: 0.1 ms more in each ms.
  cell.each = [&cell] { cell.controller.delay_ns += 100'000; };
  cell.run(700);
  EXPECT_GT(cell.ur->late(), 20);
  EXPECT_LT(cell.controller.speed(), kStill);
  EXPECT_TRUE(cell.has_said("arrive late"));
}

TEST(Ur, ASlowClockOfTheControllerIsNotLate) {
  Cell cell;
  cell.start(0);
  cell.each = [&cell] { cell.controller.delay_ns += 100; };  // 100 ppm
  cell.run(20'000);
  EXPECT_EQ(cell.ur->late(), 0);
}

TEST(Ur, NamesWhatTheControllerRefuses) {
  const auto said = [](const std::function<void(MockController&)>& change, const char* text) {
    Cell cell;
    change(cell.controller);
    cell.move(kSpeed);
    cell.run(2000);
    EXPECT_EQ(cell.states, 0) << text;
    EXPECT_EQ(cell.controller.programs(), 0);
    EXPECT_TRUE(cell.has_said(text)) << text;
    EXPECT_EQ(cell.said.size(), 1u) << "once";
  };
  said([](auto& controller) { controller.refuses_version = true; }, "refuses version 2");
  said([](auto& controller) { controller.major = 3; }, "software is 3.12; allowed: 5 or newer");
  said([](auto& controller) { controller.has_other_type = true; },
       "actual_qd is of type VECTOR6INT32; allowed: VECTOR6D");
  said([](auto& controller) { controller.has_registers_in_use = true; },
       "input_int_register_24 is in use by another program");
}

TEST(Ur, NamesAVariableThatTheControllerLacks) {
  Cell cell(2, Cell::bent(), [](auto& options) { options.torque = Ur::Torque::kReported; });
  cell.run(200);
  EXPECT_TRUE(cell.has_said("it has no actual_current_as_torque"));
}

TEST(Ur, TorquesAreCurrentsTimesConstants) {
  Cell cell(2, Cell::bent(), [](auto& options) {
    options.torque = Ur::Torque::kConstants;
    options.torque_constants = {10, 11, 12, 13, 14, 15};
  });
  cell.controller.added("actual_current") = {1, -2, 3, 0, 0, 0.5};
  cell.run(100);
  EXPECT_DOUBLE_EQ(cell.state.tau[1], -22);
  EXPECT_DOUBLE_EQ(cell.state.tau[5], 7.5);
}

/// The hand is turned by a quarter about z of the base, the tool by another about x of the flange.
TEST(Ur, TheControllersWrenchIsInTheAxesOfTheFlange) {
  Cell cell(2, Cell::bent(), [](auto& options) { options.wrench = Ur::ControllerWrench{-1, 0.5}; });
  const double quarter = std::acos(0.0);
  const Eigen::AngleAxisd R_BE(quarter, Eigen::Vector3d::UnitZ());
  const Eigen::AngleAxisd R_ET(quarter, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd R_BT(R_BE.toRotationMatrix() * R_ET.toRotationMatrix());
  const Eigen::Vector3d turn = R_BT.angle() * R_BT.axis();
  cell.controller.added("actual_TCP_pose") = {0.4, 0, 0.3, turn[0], turn[1], turn[2]};
  cell.controller.added("tcp_offset") = {0, 0, 0.2, quarter, 0, 0};
  cell.controller.added("actual_TCP_force") = {1, 2, 3, 0.1, 0.2, 0.3};
  cell.controller.added("payload") = {0.5};
  bus::TypedSubscription<ft_wrench_t> wrenches(*cell.peer, "FT_WRENCH", 1000);
  cell.run(100);
  ft_wrench_t wrench{};
  std::int64_t arrival_ns = 0;
  int count = 0;
  while (wrenches.take(wrench, arrival_ns)) ++count;
  EXPECT_NEAR(count, 47, 4) << "one for each state";
  const double expected[6] = {-2, 1, -3, -0.2, 0.1, -0.3};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(wrench.wrench[i], expected[i], 1e-12) << i;
  // A payload that has been changed at the pendant.
  cell.controller.added("payload") = {1.5};
  cell.run(10);
  while (wrenches.take(wrench, arrival_ns)) {
  }
  cell.run(100);
  EXPECT_FALSE(wrenches.take(wrench, arrival_ns));
  EXPECT_TRUE(cell.has_said("subtracts a payload of 1.5"));
}

}  // namespace
}  // namespace palpate::ur_bridge
