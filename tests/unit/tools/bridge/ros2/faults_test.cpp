#include <gtest/gtest.h>

#include <random>

#include "tests/unit/tools/bridge/ros2/cell.hpp"

namespace palpate::ros2_bridge {
namespace {

enum class Fault {
  kSilent,
  kNan,
  kLate,
  kAhead,
  kShort,
  kLacksJoint,
  kOtherMaster,
  kPalpated,
  kCount
};

constexpr double kRests = 2e-3;  // rad/s

/// One fault at a random moment of a random motion, and its end.
void run_fault(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const auto fault = static_cast<Fault>(seed % static_cast<unsigned>(Fault::kCount));
  driver::Joints q = Cell::bent(), dq(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    q[i] += uniform(-0.3, 0.3);
    dq[i] = uniform(-0.25, 0.25);
  }
  dq[0] = 0.25;
  Cell cell(q);
  cell.now_ns += static_cast<std::int64_t>(uniform(0, 10)) * 1'000'000;
  cell.rest();
  cell.run(255 + static_cast<int>(uniform(0, 30)));
  ASSERT_EQ(cell.node.received, 0) << "nothing moves before start";
  cell.move(dq);
  cell.run(static_cast<int>(uniform(80, 200)));
  ASSERT_GT(cell.node.speed(), 0.2);
  ASSERT_TRUE(cell.protocol->complaint().empty());

  MockNode& node = cell.node;
  node.is_silent = fault == Fault::kSilent;
  node.has_nan = fault == Fault::kNan;
  node.is_short = fault == Fault::kShort;
  node.lacks_joint = fault == Fault::kLacksJoint;
  if (fault == Fault::kLate) node.age_ns = static_cast<std::int64_t>(uniform(101, 900)) * 1'000'000;
  if (fault == Fault::kAhead)
    node.age_ns = -static_cast<std::int64_t>(uniform(101, 900)) * 1'000'000;
  if (fault == Fault::kOtherMaster)
    cell.each = [&cell] {
      if (cell.now_ns / 1'000'000 % 5 == 3) cell.node.command_otherwise();
    };
  cell.is_palpated_dead = fault == Fault::kPalpated;
  // palpated's own silence counts after 100 ms.
  cell.run(fault == Fault::kPalpated ? 180 : 100);
  ASSERT_LT(node.speed(), kRests) << "stops within 100 ms";
  const Intake::Counts& counts = cell.protocol->intake().counts();
  const bool is_counted = counts.malformed + counts.late + counts.ahead > 20;
  ASSERT_EQ(is_counted,
            fault != Fault::kSilent && fault != Fault::kOtherMaster && fault != Fault::kPalpated);
  ASSERT_EQ(cell.has_said("states: "), is_counted);
  if (fault == Fault::kPalpated) return;  // its commands are the motion's reason

  // The fault ends, and palpated commands on.
  cell.run(static_cast<int>(uniform(1, 100)));
  node.is_silent = node.has_nan = node.is_short = node.lacks_joint = false;
  node.age_ns = 0;
  const driver::Joints stood = node.q();
  cell.run(350);
  ASSERT_LT((node.q() - stood).norm(), 1e-4) << "rests until palpated is stopped";
  if (fault == Fault::kOtherMaster) {
    cell.each = {};
    cell.run(1010);
    ASSERT_LT((node.q() - stood).norm(), 1e-4);
  }
  cell.rest();
  cell.run(15);
  cell.move(dq);
  cell.run(120);
  ASSERT_GT(node.speed(), 0.2) << "moves after stop and start";
}

TEST(Ros2Faults, TheArmStopsWithin100MsAndRestsInEachOfAThousandDraws) {
  testing::internal::CaptureStderr();  // the latch prints each stop
  for (unsigned seed = 0; seed < 1000 && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", fault " +
                 std::to_string(seed % static_cast<unsigned>(Fault::kCount)));
    run_fault(seed);
  }
  const std::string printed = testing::internal::GetCapturedStderr();
  EXPECT_NE(printed.find("another program commands the arm: rests"), std::string::npos);
}

}  // namespace
}  // namespace palpate::ros2_bridge
