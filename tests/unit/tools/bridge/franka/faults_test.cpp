#include <gtest/gtest.h>

#include <random>

#include "tests/unit/tools/bridge/franka/cell.hpp"

namespace palpate::franka_bridge {
namespace {

enum class FrankaFault {
  kDisconnect,
  kRestart,
  kOtherVersion,
  kLate,
  kSilent,
  kDeaf,
  kNan,
  kUserStop,
  kCollision,
  kOtherMaster,
  kOtherProgram,
  kCount
};

constexpr double kRests = 2e-3;  // rad/s

void begin_fault(FrankaFault fault, MockArm& mock, double delay) {
  mock.is_absent = fault == FrankaFault::kDisconnect;
  mock.is_mute = fault == FrankaFault::kSilent;
  mock.is_deaf = fault == FrankaFault::kDeaf;
  mock.has_nan = fault == FrankaFault::kNan;
  mock.is_user_stopped = fault == FrankaFault::kUserStop;
  mock.is_moved_by_others = fault == FrankaFault::kOtherProgram;
  mock.is_taken = fault == FrankaFault::kOtherMaster;
  if (fault == FrankaFault::kOtherVersion) mock.version = 9;
  if (fault == FrankaFault::kLate) mock.delay_ns = static_cast<std::int64_t>(1e9 * delay);
  if (fault == FrankaFault::kCollision) mock.collide();
  if (fault == FrankaFault::kRestart || fault == FrankaFault::kOtherVersion ||
      fault == FrankaFault::kOtherMaster)
    mock.restart();
}

void end_fault(MockArm& mock) {
  mock.is_absent = mock.is_mute = mock.is_deaf = mock.has_nan = mock.is_taken = false;
  mock.version = kFciVersion;
  mock.delay_ns = 0;
  mock.release();
}

/// One fault at a random moment of a random motion, and its end.
void run_franka_fault(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const auto fault = static_cast<FrankaFault>(seed % static_cast<unsigned>(FrankaFault::kCount));
  driver::Joints q = Cell::bent(), dq(kJoints);
  for (int i = 0; i < kJoints; ++i) {
    q[i] += uniform(-0.3, 0.3);
    dq[i] = uniform(-0.25, 0.25);
  }
  dq[0] = 0.25;
  Cell cell(q);
  cell.now_ns += static_cast<std::int64_t>(uniform(0, 10)) * 1'000'000;
  cell.rest();
  cell.run(265 + static_cast<int>(uniform(0, 15)));
  MockArm& mock = cell.mock;
  ASSERT_EQ(mock.commands() + mock.motions(), 0) << "nothing moves before start";
  cell.move(dq);
  cell.run(static_cast<int>(uniform(75, 120)));
  ASSERT_GT(mock.speed(), 0.2);
  ASSERT_EQ(mock.reflexes(), 0);

  begin_fault(fault, mock, uniform(0.07, 0.15));
  cell.run(100);
  ASSERT_LT(mock.speed(), kRests) << "stops within 100 ms";

  // The fault ends, and palpated commands on.
  cell.run(static_cast<int>(uniform(1, 40)));
  end_fault(mock);
  const driver::Joints stood = mock.q();
  // Until late states have passed and 0.25 s more, or a connection is tried again, twice if
  // refused.
  const bool connects = fault == FrankaFault::kRestart || fault == FrankaFault::kOtherVersion ||
                        fault == FrankaFault::kOtherMaster;
  cell.run(connects ? 850 : 410);
  ASSERT_LT((mock.q() - stood).norm(), 1e-4) << "rests until palpated is stopped";
  ASSERT_EQ(mock.motions(), 1);

  cell.rest();
  cell.run(15);
  cell.move(dq);
  cell.run(80);
  ASSERT_GT(mock.speed(), 0.2) << "moves after stop and start";
  ASSERT_EQ(mock.violation(), "");
}

TEST(FrankaFaults, TheArmStopsWithin100MsAndRestsInEachOfAThousandDraws) {
  testing::internal::CaptureStderr();  // the latch prints each stop
  for (unsigned seed = 0; seed < 1000 && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", fault " +
                 std::to_string(seed % static_cast<unsigned>(FrankaFault::kCount)));
    run_franka_fault(seed);
  }
  const std::string printed = testing::internal::GetCapturedStderr();
  for (const char* reason : {"user stop of the arm", "reflex of the arm",
                             "the arm has ended the motion", "the arm's driver has begun"})
    EXPECT_NE(printed.find(std::string(reason) + ": rests until palpated is stopped"),
              std::string::npos)
        << reason;
}

}  // namespace
}  // namespace palpate::franka_bridge
