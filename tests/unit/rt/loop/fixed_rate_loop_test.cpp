#include "rt/loop/fixed_rate_loop.hpp"

#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <limits>
#include <thread>
#include <vector>

#include "rt/loop/allocation_counter.hpp"
#include "rt/loop/real_time.hpp"
#include "rt/loop/sanitizer.hpp"

namespace palpate::loop {
namespace {

TEST(FixedRateLoop, TicksOnTheGridUntilItIsStopped) {
  LoopOptions options;
  options.period = 2e-3;
  FixedRateLoop loop(options);
  std::atomic<bool> stop{false};
  std::vector<Tick> ticks;
  loop.run(stop, [&](const FixedRateLoop::Tick& tick) {
    ticks.push_back(tick);
    if (ticks.size() == 20) stop = true;
  });
  ASSERT_EQ(ticks.size(), 20u);
  const std::int64_t origin = ticks[0].now_ns - ticks[0].lateness_ns;
  std::int64_t points = 0;
  for (const Tick& tick : ticks) {
    ASSERT_GE(tick.lateness_ns, 0);
    // Regardless of missed cycles, wake-ups lie on one time grid.
    EXPECT_EQ((tick.now_ns - tick.lateness_ns - origin) % 2'000'000, 0);
    points += tick.missed;
  }
  EXPECT_EQ(loop.grid().overruns() > 0, points > 0);
}

TEST(FixedRateLoop, CountsAnOverrunThatItsTickCauses) {
  LoopOptions options;
  options.period = 1e-3;
  FixedRateLoop loop(options);
  std::atomic<bool> stop{false};
  std::int64_t missed = 0;
  int cycles = 0;
  loop.run(stop, [&](const FixedRateLoop::Tick& tick) {
    missed += tick.missed;
    if (++cycles == 1) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (cycles == 3) stop = true;
  });
  EXPECT_GE(missed, 4);
  EXPECT_GE(loop.grid().overruns(), 1);
  EXPECT_GE(loop.grid().overrun_ns(), 4'000'000);
}

TEST(FixedRateLoop, SaysOfEachRefusalWhyAndHow) {
  LoopOptions options;
  options.cpu = 100000;
  options.fifo_priority = 1000;
  options.lock_memory = false;
  FixedRateLoop loop(options);
  std::string refusals;
  std::thread([&] { refusals = loop.acquire_real_time(); }).join();
  EXPECT_NE(refusals.find("no processor has the number 100000"), std::string::npos);
  EXPECT_NE(refusals.find("LimitRTPRIO"), std::string::npos) << refusals;
}

TEST(FixedRateLoop, AProcessorThatThisMachineHasNotIsRefusedByItsNumber) {
  constexpr int kAbsent = CPU_SETSIZE - 1;
  if (sysconf(_SC_NPROCESSORS_CONF) > kAbsent) GTEST_SKIP() << "this machine has them all";
  cpu_set_t before, after;
  ASSERT_EQ(sched_getaffinity(0, sizeof(before), &before), 0);
  EXPECT_NE(take_cpu(kAbsent).find("not bound to processor " + std::to_string(kAbsent)),
            std::string::npos);
  EXPECT_NE(take_cpu(-1).find("no processor has the number -1"), std::string::npos);
  ASSERT_EQ(sched_getaffinity(0, sizeof(after), &after), 0);
  EXPECT_TRUE(CPU_EQUAL(&before, &after)) << "a refusal changes nothing";
}

TEST(FixedRateLoop, AFiniteLimitRefusesToLockAndSaysHowToRaiseIt) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer maps more than can be locked";
  // In a child process, since dropped privileges are not regained.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit finite{1 << 20, 1 << 20};
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    const __user_cap_data_struct none[2]{};
    if (setrlimit(RLIMIT_MEMLOCK, &finite) != 0 || syscall(SYS_capset, &header, none) != 0)
      _exit(77);
    const std::string refusal = lock_and_prefault_memory();
    const bool names_remedy = refusal.find("LimitMEMLOCK=infinity") != std::string::npos;
    // Later requests must still be granted.
    void* later =
        mmap(nullptr, 64 << 20, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    _exit(names_remedy && !memory_is_locked() && later != MAP_FAILED ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
    GTEST_SKIP() << "capabilities cannot be given up here";
  EXPECT_EQ(status, 0);
}

TEST(FixedRateLoop, WhatIsGrantedHoldsForTheCallingThread) {
  LoopOptions options;
  options.lock_memory = false;
  options.fifo_priority = 10;
  cpu_set_t allowed;
  ASSERT_EQ(sched_getaffinity(0, sizeof(allowed), &allowed), 0);
  for (int cpu = 0; cpu < CPU_SETSIZE && options.cpu < 0; ++cpu)
    if (CPU_ISSET(static_cast<unsigned>(cpu), &allowed)) options.cpu = cpu;
  FixedRateLoop loop(options);
  std::thread([&] {
    const std::string refusals = loop.acquire_real_time();
    EXPECT_EQ(sched_getcpu(), options.cpu) << refusals;
    const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
    EXPECT_EQ(policy == SCHED_FIFO, refusals.empty()) << refusals;
    if (!refusals.empty()) return;
    // A thread started by a real-time thread is an ordinary one.
    std::thread([] { EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER); }).join();
  }).join();
}

TEST(FixedRateLoop, LockedAndPrefaultedMemoryFaultsNoMore) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer maps more than can be locked";
  // In a child process, since locked memory stays locked.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (!lock_and_prefault_memory().empty()) _exit(77);
    const std::int64_t before = page_faults_of_this_thread();
    volatile char stack[100'000];
    stack[0] = stack[sizeof(stack) - 1] = 1;
    constexpr std::size_t kSize = 4 << 20;
    auto* heap = static_cast<volatile char*>(std::malloc(kSize));
    for (std::size_t i = 0; i < kSize; i += 1024) heap[i] = 1;
    _exit(page_faults_of_this_thread() == before ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
    GTEST_SKIP() << "locking memory is not granted here";
  EXPECT_EQ(status, 0);
}

TEST(FixedRateLoop, RefusesAPeriodOutOfRange) {
  LoopOptions options;
  for (const double period : {0.0, -1.0, 1e-7, 1e3, std::numeric_limits<double>::quiet_NaN()}) {
    options.period = period;
    EXPECT_THROW(FixedRateLoop{options}, std::invalid_argument) << period;
  }
}

}  // namespace
}  // namespace palpate::loop
