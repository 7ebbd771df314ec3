// Which of the daemon's threads may preempt others.

#include <sched.h>

#include <filesystem>
#include <map>

#include "tests/process/faults/fault_process.hpp"

namespace palpate {
namespace {

bool fifo_is_granted() {
  bool granted = false;
  std::thread([&granted] {
    sched_param parameters{};
    parameters.sched_priority = 50;
    granted = sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
  }).join();
  return granted;
}

/// Priorities of all threads that are SCHED_FIFO.
std::map<int, int> fifo_threads(int process) {
  std::map<int, int> count;
  const std::string folder = "/proc/" + std::to_string(process) + "/task";
  for (const auto& task : std::filesystem::directory_iterator(folder)) {
    const int id = std::stoi(task.path().filename());
    sched_param parameters{};
    if ((sched_getscheduler(id) & ~SCHED_RESET_ON_FORK) != SCHED_FIFO) continue;
    if (sched_getparam(id, &parameters) == 0) ++count[parameters.sched_priority];
  }
  return count;
}

using Scheduling = FaultProcess;

TEST_F(Scheduling, OnlyLoopAndReceiverAreFifo) {
  if (!fifo_is_granted()) GTEST_SKIP() << "SCHED_FIFO is not granted here";
  ChildProcess daemon(command());
  health_t health{};
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
      << daemon.output();
  EXPECT_EQ(fifo_threads(daemon.pid()), (std::map<int, int>{{49, 1}, {50, 1}}));

  ChildProcess ordinary({kDaemon, "--config", kExample, "--set",
                         "bus.control=" + support::private_url(2), "--set",
                         "bus.housekeeping=" + housekeeping_url_, "--set", "loop.fifo_priority=0"});
  const std::int64_t session = health.session;
  ASSERT_TRUE(wait_health(
      [session](const health_t& h) { return h.session != session && h.cycles > 200; }, health))
      << ordinary.output();
  EXPECT_TRUE(fifo_threads(ordinary.pid()).empty());
}

}  // namespace
}  // namespace palpate
