#include "sim/scenes/pacing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "core/math/random.hpp"

namespace palpate::scenes {
namespace {

struct Exchange {
  std::shared_ptr<bus::MemoryHub> hub = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> ours = bus::make_memory_bus(hub);
  std::unique_ptr<bus::MessageBus> theirs = bus::make_memory_bus(hub);
  LockStep lock_step{*ours, 9, 0.1};
  bus::TypedPublisher<tick_done_t> done{*theirs, "TICK_DONE"};
  bus::TypedSubscription<sim_tick_t> ticks{*theirs, "SIM_TICK", 64};

  LockStep::Answer exchange(std::int64_t tick, const std::atomic<bool>& stop) {
    lock_step.send(tick, 1000, 777);
    return lock_step.wait(stop);
  }

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
  EXPECT_EQ(e.exchange(42, stop), LockStep::Answer::kDone);
  sim_tick_t tick{};
  std::int64_t arrival_ns = 0;
  ASSERT_TRUE(e.ticks.take(tick, arrival_ns));
  EXPECT_EQ(tick.tick, 42);
  EXPECT_EQ(tick.period_us, 1000);
  EXPECT_EQ(tick.utime, 777);
  EXPECT_EQ(tick.session, 9);
}

TEST(LockStep, AnAnswerThatArrivesBeforeTheWaitIsNotLost) {
  Exchange e;
  const std::atomic<bool> stop{false};
  e.lock_step.send(7, 1000, 0);
  e.answer(7);
  EXPECT_EQ(e.lock_step.wait(stop), LockStep::Answer::kDone);
  EXPECT_EQ(e.lock_step.repeats(), 0);
}

TEST(LockStep, AnswersToOtherTicksDoNotCount) {
  Exchange e;
  e.answer(41);
  const std::atomic<bool> stop{true};
  EXPECT_EQ(e.exchange(42, stop), LockStep::Answer::kStopped);
}

TEST(LockStep, SendsAgainUntilItGivesUp) {
  Exchange e;
  const std::atomic<bool> stop{false};
  EXPECT_EQ(e.exchange(1, stop), LockStep::Answer::kNone);
  EXPECT_GT(e.lock_step.repeats(), 1);
}

// One message in twenty is lost in either direction: every tick is still executed, in order, and
// none twice.
TEST(LockStep, LossesDelayTicksButLoseNone) {
  Exchange e;
  LockStep patient(*e.ours, 9, 5);
  std::atomic<bool> over{false};
  std::vector<std::int64_t> run;
  std::thread daemon([&] {
    math::Random random(6);
    sim_tick_t tick{};
    std::int64_t arrival_ns = 0, last = 0;
    while (!over) {
      if (!e.ticks.take(tick, arrival_ns)) {
        std::this_thread::yield();
        continue;
      }
      if (random.uniform() < 0.05) continue;  // SIM_TICK lost
      if (tick.tick > last) run.push_back(last = tick.tick);
      if (random.uniform() >= 0.05) e.answer(tick.tick);  // otherwise TICK_DONE lost
    }
  });
  constexpr std::int64_t kTicks = 1000;
  const std::atomic<bool> stop{false};
  int done = 0;
  for (std::int64_t tick = 1; tick <= kTicks; ++tick) {
    patient.send(tick, 1000, 1000 * tick);
    done += patient.wait(stop) == LockStep::Answer::kDone;
  }
  over = true;
  daemon.join();
  EXPECT_EQ(done, kTicks);
  EXPECT_GT(patient.repeats(), kTicks / 20);
  ASSERT_EQ(run.size(), static_cast<std::size_t>(kTicks));
  EXPECT_TRUE(std::is_sorted(run.begin(), run.end()));
}

}  // namespace
}  // namespace palpate::scenes
