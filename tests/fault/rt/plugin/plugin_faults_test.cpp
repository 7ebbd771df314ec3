// Every slot with a plug-in that errs or hangs in the loop, at a random cycle: its fallback takes
// over in that cycle, or the robot gets a zero command; no number that is not finite leaves the
// pipeline; a hang is noticed in time. PALPATE_PLUGIN_SEEDS sets the number of seeds of each row.

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <thread>

#include "rt/daemon/plugin_watchdog.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "tests/unit/rt/plugin/plugged_pipeline.hpp"

namespace palpate::plugin {
namespace {

int seeds() {
  const char* given = std::getenv("PALPATE_PLUGIN_SEEDS");
  return given == nullptr ? 2 : std::max(1, std::atoi(given));
}

constexpr int kEarliest = 30, kLatest = 60;  // cycle of the fault, in calls of the component

/// The bar as a small mesh, with a plug-in in `slot` that does this from a random cycle on.
std::vector<std::string> settings(const unruly::Slot& slot, const std::string& does,
                                  const std::string& more, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  const int after = std::uniform_int_distribution<int>(kEarliest, kLatest)(random);
  std::vector<std::string> overrides{
      kUnruly, "object.order=linear",
      "object.mesh={box: {size: [0.5, 0.06, 0.06], cells: [6, 1, 1]}}"};
  if (slot.configured != sensor) overrides.push_back(sensor("nothing"));
  overrides.push_back(slot.configured(does, ", after: " + std::to_string(after) + more));
  return overrides;
}

std::string name_of(const unruly::Slot& slot) { return slot.name; }

class PluginFaults
    : public ::testing::TestWithParam<std::tuple<unruly::Slot, const char* /*does*/, bool>> {};

TEST_P(PluginFaults, AreHandledInTheirCycle) {
  const auto& [slot, does, has_fallback] = GetParam();
  for (int seed = 0; seed < seeds(); ++seed) {
    Running running(settings(
        slot, does, has_fallback ? std::string(", fallback: ") + slot.fallback : "", seed));
    running.run(kEarliest - 5);
    int pauses = 0;  // cycles without a command
    for (int cycle = 0; cycle < 2 * kLatest - kEarliest; ++cycle) {
      running.run(1);  // expects finite commands
      if (running.speed == 0) ++pauses;
    }
    const pipeline::Condition condition = running.pipeline.condition();
    if (has_fallback) {
      EXPECT_TRUE(running.pipeline.on_fallback()) << seed;
      EXPECT_EQ(condition.state, pipeline::LifeCycle::kDegraded) << seed << condition.reason;
      EXPECT_TRUE(running.pipeline.model().positions().allFinite());
      // A sensor's fallback tares first; a model without sensitivity steers nothing before.
      if (slot.configured != sensor && slot.configured != model) {
        EXPECT_EQ(pauses, 0) << seed;
      }
    } else {
      EXPECT_EQ(running.speed, 0) << seed;
      EXPECT_GE(static_cast<int>(condition.state), static_cast<int>(pipeline::LifeCycle::kDegraded))
          << seed << condition.reason;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, PluginFaults,
                         ::testing::Combine(::testing::ValuesIn(kSlots),
                                            ::testing::ValuesIn(kErrors), ::testing::Bool()),
                         [](const auto& row) {
                           return name_of(std::get<0>(row.param)) + "_" + std::get<1>(row.param) +
                                  (std::get<2>(row.param) ? "_with_fallback" : "");
                         });

/// What the watchdog noticed: ms since the last cycle (negative: nothing), and in which component.
struct Notice {
  double ms = -1;
  std::array<char, 64> component{};
};

/// Runs a loop that hangs. Ends this process as soon as the watchdog acts.
[[noreturn]] void hang(const unruly::Slot& slot, int seed, int pipe) {
  constexpr unsigned kPatience = 60;  // s
  alarm(kPatience);
  Running running(settings(slot, "hang", "", seed));
  std::atomic<std::int64_t> cycles{0}, last_ns{0};
  daemon::PluginWatchdog watchdog({}, cycles, [&](const char* component) {
    Notice notice;
    notice.ms = 1e-6 * static_cast<double>(loop::monotonic_ns() - last_ns);
    std::strncpy(notice.component.data(), component, notice.component.size() - 1);
    _exit(write(pipe, &notice, sizeof notice) == sizeof notice ? 0 : 1);
  });
  std::thread thread([&] {
    const auto watched = watchdog.watch_this_thread();
    for (;; ++cycles) {
      running.run(1);
      last_ns = loop::monotonic_ns();
    }
  });
  thread.join();
  _exit(1);
}

/// In a process of its own, since the thread of such a loop cannot be ended.
Notice notice_of_hang(const unruly::Slot& slot, int seed) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("cannot make a pipe");
  const pid_t child = fork();
  if (child == 0) hang(slot, seed, ends[1]);
  close(ends[1]);
  Notice notice;
  if (read(ends[0], &notice, sizeof notice) != sizeof notice) notice.ms = -1;
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return notice;
}

class PluginHangs : public ::testing::TestWithParam<unruly::Slot> {};

TEST_P(PluginHangs, AreNoticedWithinTwentyMilliseconds) {
  constexpr double kLimit = 20;  // ms
  constexpr int kAttempts = 20;  // other programs may take the processor
  std::vector<double> times;
  int repeated = 0;
  for (int seed = 0; seed < seeds(); ++seed) {
    Notice notice = notice_of_hang(GetParam(), seed);
    for (int i = 1; i < kAttempts && notice.ms > kLimit; ++i, ++repeated)
      notice = notice_of_hang(GetParam(), seed);
    EXPECT_GE(notice.ms, 10) << seed;
    EXPECT_LE(notice.ms, kLimit) << seed;
    EXPECT_NE(std::string(notice.component.data()).find(GetParam().component), std::string::npos)
        << seed << notice.component.data();
    times.push_back(notice.ms);
  }
  std::sort(times.begin(), times.end());
  std::printf("%s hangs: noticed after %.1f ms (p50), %.1f ms (longest) of %zu; %d repeated\n",
              GetParam().name, times[times.size() / 2], times.back(), times.size(), repeated);
}

INSTANTIATE_TEST_SUITE_P(Table, PluginHangs, ::testing::ValuesIn(kSlots),
                         [](const auto& row) { return name_of(row.param); });

}  // namespace
}  // namespace palpate::plugin
