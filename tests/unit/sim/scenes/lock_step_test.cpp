#include "sim/scenes/lock_step.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace palpate::scenes {
namespace {

struct Exchange {
  std::shared_ptr<bus::MemoryHub> hub = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> ours = bus::make_memory_bus(hub);
  std::unique_ptr<bus::MessageBus> theirs = bus::make_memory_bus(hub);
  LockStep lock_step{*ours, 9, 0.1};
  bus::TypedPublisher<tick_done_t> done{*theirs, "TICK_DONE"};
  bus::TypedSubscription<sim_tick_t> ticks{*theirs, "SIM_TICK", 64};

  void answer(std::int64_t tick) {
    tick_done_t message{};
    message.tick = tick;
    done.publish(message);
  }
};

TEST(LockStep, SendsTheTickAndTakesItsAnswer) {
  Exchange e;
  e.answer(42);
  const std::atomic<bool> stop{false};
  EXPECT_EQ(e.lock_step.exchange(42, 1000, 777, stop), LockStep::Answer::kDone);
  sim_tick_t tick{};
  std::int64_t arrival_ns = 0;
  ASSERT_TRUE(e.ticks.take(tick, arrival_ns));
  EXPECT_EQ(tick.tick, 42);
  EXPECT_EQ(tick.period_us, 1000);
  EXPECT_EQ(tick.utime, 777);
  EXPECT_EQ(tick.session, 9);
}

TEST(LockStep, AnswersToOtherTicksDoNotCount) {
  Exchange e;
  e.answer(41);
  const std::atomic<bool> stop{true};
  EXPECT_EQ(e.lock_step.exchange(42, 1000, 0, stop), LockStep::Answer::kStopped);
}

TEST(LockStep, SendsAgainUntilItGivesUp) {
  Exchange e;
  const std::atomic<bool> stop{false};
  EXPECT_EQ(e.lock_step.exchange(1, 1000, 0, stop), LockStep::Answer::kNone);
  EXPECT_GT(e.lock_step.repeats(), 1);
}

}  // namespace
}  // namespace palpate::scenes
