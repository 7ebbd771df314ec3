#include "rt/daemon/plugin_watchdog.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace palpate::daemon {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A loop's thread that is claimed never ends, nor does what it uses.
struct Hanging {
  std::atomic<std::int64_t> cycles{0};
  std::atomic<bool> acted{false}, left{false};
  Clock::time_point begin = Clock::now();
  double after = 0;  // s
  PluginWatchdog watchdog{{}, cycles, [this](const char*) {
                            after = seconds_since(begin);
                            acted = true;
                          }};
};

void wait_until(const std::atomic<bool>& flag) {
  const auto begin = Clock::now();
  while (!flag && seconds_since(begin) < 5)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(PluginWatchdog, StopsAThreadWhoseCallDoesNotReturn) {
  auto* const hanging = new Hanging;  // is never deleted
  std::thread([hanging] {
    const auto watched = hanging->watchdog.watch_this_thread();
    {
      const plugin::InCall call("a law");
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
    hanging->left = true;
  }).detach();
  wait_until(hanging->acted);
  ASSERT_TRUE(hanging->acted);
  EXPECT_GE(hanging->after, 0.01);
  EXPECT_LT(hanging->after, 0.2);
  while (hanging->watchdog.hung() == nullptr) std::this_thread::yield();
  EXPECT_STREQ(hanging->watchdog.hung(), "a law");
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  EXPECT_FALSE(hanging->left) << "the thread sleeps where its call has returned";
}

TEST(PluginWatchdog, NoticesOneThatComputesForEver) {
  auto* const hanging = new Hanging;  // is never deleted
  std::thread([hanging] {
    const auto watched = hanging->watchdog.watch_this_thread();
    const plugin::InCall call("a law");
    while (!hanging->acted) {
    }
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }).detach();
  wait_until(hanging->acted);
  EXPECT_TRUE(hanging->acted);
}

TEST(PluginWatchdog, LeavesAloneWhatMovesAndWhatIsOutsideOfPlugins) {
  std::atomic<std::int64_t> cycles{0};
  PluginWatchdog watchdog({}, cycles, [](const char*) { FAIL(); });
  std::thread thread([&] {
    const auto watched = watchdog.watch_this_thread();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // in no call
    for (int i = 0; i < 50; ++i) {
      const plugin::InCall call("a law");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++cycles;
    }
  });
  thread.join();
  EXPECT_EQ(watchdog.hung(), nullptr);
}

TEST(PluginWatchdog, HasNoThreadIfItIsNotNeeded) {
  std::atomic<std::int64_t> cycles{0};
  PluginWatchdog::Options options;
  options.enabled = false;
  PluginWatchdog watchdog(options, cycles, [](const char*) { FAIL(); });
  const auto watched = watchdog.watch_this_thread();
  const plugin::InCall call("a law");
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_EQ(watchdog.hung(), nullptr);
}

}  // namespace
}  // namespace palpate::daemon
