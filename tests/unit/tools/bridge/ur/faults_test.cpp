#include <gtest/gtest.h>

#include <random>

#include "tests/unit/tools/bridge/ur/cell.hpp"

namespace palpate::ur_bridge {
namespace {

enum class UrFault {
  kDisconnect,
  kRestart,
  kOtherVersion,
  kLate,
  kSilent,
  kNan,
  kEmergencyStop,
  kProtectiveStop,
  kOtherProgram,
  kProgramStopped,
  kCount
};

constexpr double kRests = 2e-3;  // rad/s

void begin_fault(UrFault fault, MockController& controller, double delay) {
  controller.is_absent = fault == UrFault::kDisconnect;
  controller.is_mute = fault == UrFault::kSilent;
  controller.refuses_version = fault == UrFault::kOtherVersion;
  controller.has_nan = fault == UrFault::kNan;
  controller.is_emergency_stopped = fault == UrFault::kEmergencyStop;
  controller.is_protectively_stopped = fault == UrFault::kProtectiveStop;
  if (fault == UrFault::kLate) controller.delay_ns = static_cast<std::int64_t>(1e9 * delay);
  if (fault == UrFault::kRestart || fault == UrFault::kOtherVersion) controller.restart();
  if (fault == UrFault::kOtherProgram) controller.run_other_program();
  if (fault == UrFault::kProgramStopped) controller.stop_program();
}

void end_fault(UrFault fault, MockController& controller) {
  controller.is_absent = controller.is_mute = controller.has_nan = controller.refuses_version =
      false;
  controller.delay_ns = 0;
  controller.release_stops();
  if (fault == UrFault::kOtherProgram) controller.stop_program();
}

/// One fault at a random moment of a random motion, and its end.
void run_ur_fault(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const auto fault = static_cast<UrFault>(seed / 2 % static_cast<unsigned>(UrFault::kCount));
  driver::Joints q = Cell::bent(), dq(Ur::kJoints);
  for (int i = 0; i < Ur::kJoints; ++i) {
    q[i] += uniform(-0.3, 0.3);
    dq[i] = uniform(-0.25, 0.25);
  }
  dq[0] = 0.25;
  Cell cell(seed % 2 == 0 ? 2 : 8, q);
  cell.now_ns += static_cast<std::int64_t>(uniform(0, 10)) * 1'000'000;
  cell.rest();
  cell.run(290 + static_cast<int>(uniform(0, 30)));
  MockController& controller = cell.controller;
  ASSERT_EQ(controller.commands() + controller.programs(), 0) << "nothing moves before start";
  cell.move(dq);
  cell.run(static_cast<int>(uniform(180, 300)));
  ASSERT_GT(controller.speed(), 0.2);

  begin_fault(fault, controller, uniform(0.07, 0.2));
  cell.run(100);
  ASSERT_LT(controller.speed(), kRests) << "stops within 100 ms";

  // The fault ends, and palpated commands on.
  cell.run(static_cast<int>(uniform(1, 200)));
  end_fault(fault, controller);
  const driver::Joints stood = controller.q();
  // Until late states have passed and 0.25 s more, or a connection is tried again, twice if
  // refused.
  const bool connects = fault == UrFault::kRestart || fault == UrFault::kOtherVersion;
  cell.run(connects ? 1100 : 500);
  ASSERT_LT((controller.q() - stood).norm(), 1e-4) << "rests until palpated is stopped";

  cell.rest();
  cell.run(15);
  cell.move(dq);
  cell.run(250);
  ASSERT_GT(controller.speed(), 0.2) << "moves after stop and start";
  ASSERT_EQ(controller.violation(), "");
}

TEST(UrFaults, TheArmStopsWithin100MsAndRestsInEachOfAThousandDraws) {
  testing::internal::CaptureStderr();  // the latch prints each stop
  for (unsigned seed = 0; seed < 1000 && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", fault " +
                 std::to_string(seed / 2 % static_cast<unsigned>(UrFault::kCount)));
    run_ur_fault(seed);
  }
  const std::string printed = testing::internal::GetCapturedStderr();
  for (const char* reason : {"emergency stop of the robot", "protective stop of the arm",
                             "the arm's program has ended", "the arm's driver has begun"})
    EXPECT_NE(printed.find(std::string(reason) + ": rests until palpated is stopped"),
              std::string::npos)
        << reason;
}

}  // namespace
}  // namespace palpate::ur_bridge
