#include <gtest/gtest.h>

#include <random>

#include "tests/unit/tools/bridge/drake/cell.hpp"

namespace palpate::drake_bridge {
namespace {

using FaultKind = MockDriver::Kind;

enum class Fault { kDisconnect, kRestart, kOtherType, kLate, kNan, kButton, kOtherMaster, kCount };

constexpr double kRests = 2e-3;  // rad/s

/// One fault at a random moment of a random motion, and its end.
void run_fault(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const auto kind = seed % 2 == 0 ? FaultKind::kIiwa : FaultKind::kPanda;
  const auto fault = static_cast<Fault>(seed / 2 % static_cast<unsigned>(Fault::kCount));
  driver::Joints q = Cell::bent(), dq(Cell::kJoints);
  for (int i = 0; i < Cell::kJoints; ++i) {
    q[i] += uniform(-0.3, 0.3);
    dq[i] = uniform(-0.25, 0.25);
  }
  dq[0] = 0.25;
  Cell cell(kind, q);
  cell.now_ns += static_cast<std::int64_t>(uniform(0, 10)) * 1'000'000;
  cell.rest();
  cell.run(255 + static_cast<int>(uniform(0, 30)));
  ASSERT_EQ(cell.drake.received(), 0) << "nothing moves before start";
  cell.move(dq);
  cell.run(static_cast<int>(uniform(80, 200)));
  ASSERT_GT(cell.drake.speed(), 0.2);

  MockDriver& drake = cell.drake;
  drake.is_absent = fault == Fault::kDisconnect;
  drake.is_mute = fault == Fault::kRestart;
  drake.has_other_type = fault == Fault::kOtherType;
  drake.has_nan = fault == Fault::kNan;
  drake.is_stopped = fault == Fault::kButton;
  if (fault == Fault::kLate)
    drake.delay_ns = static_cast<std::int64_t>(uniform(70, 200)) * 1'000'000;
  if (fault == Fault::kRestart) drake.restart();
  if (fault == Fault::kOtherMaster)
    cell.each = [&cell] {
      if (cell.now_ns / 1'000'000 % 5 == 3) cell.publish_foreign_command();
    };
  // The arm of a panda whose commands do not arrive stops by its driver's limit of 100 ms.
  cell.run(fault == Fault::kDisconnect && kind == FaultKind::kPanda ? 130 : 100);
  ASSERT_LT(drake.speed(), kRests) << "stops within 100 ms";

  // The fault ends, and palpated commands on.
  // IIWA_STATUS reports no button: it shows by the arm's lag.
  cell.run(static_cast<int>(uniform(1, 100)) + (fault == Fault::kButton ? 150 : 0));
  drake.is_absent = drake.is_mute = drake.has_other_type = drake.has_nan = drake.is_stopped = false;
  drake.delay_ns = 0;
  const driver::Joints stood = drake.q();
  // A lag counts as a stop for half a second.
  cell.run(fault == Fault::kButton ? 700 : 350);
  ASSERT_LT((drake.q() - stood).norm(), 1e-4) << "rests until palpated is stopped";
  if (fault == Fault::kOtherMaster) {
    cell.each = {};
    cell.run(1010);
    ASSERT_LT((drake.q() - stood).norm(), 1e-4);
  }
  ASSERT_FALSE(drake.gave_up()) << "no command within 0.25 s of a first status";

  cell.rest();
  cell.run(15);
  cell.move(dq);
  cell.run(120);
  ASSERT_GT(drake.speed(), 0.2) << "moves after stop and start";
}

TEST(DrakeFaults, TheArmStopsWithin100MsAndRestsInEachOfAThousandDraws) {
  testing::internal::CaptureStderr();  // the latch prints each stop
  for (unsigned seed = 0; seed < 1000 && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", fault " +
                 std::to_string(seed / 2 % static_cast<unsigned>(Fault::kCount)));
    run_fault(seed);
  }
  const std::string printed = testing::internal::GetCapturedStderr();
  EXPECT_NE(printed.find("user stop of the arm: rests until palpated is stopped"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::drake_bridge
