#include "tests/unit/tools/doctor/tree.hpp"

namespace palpate::doctor {
namespace {

using RealTime = Tree;

TEST_F(RealTime, AGoodMachineIsWell) {
  for (const Finding& one : all()) EXPECT_EQ(one.verdict, Verdict::kOk) << one.check << one.found;
  EXPECT_EQ(all().size(), 20u);
}

TEST_F(RealTime, AnEmptyTreeIsExaminedWithoutACrash) {
  const support::ScratchFolder empty;
  const Machine machine(empty.path());
  EXPECT_FALSE(check_real_time(machine, {}).empty());
  EXPECT_FALSE(check_network(machine, {}).empty());
  EXPECT_FALSE(check_programs(machine, "x").empty());
}

TEST_F(RealTime, KernelWithoutRealTime) {
  put("proc/version", "Linux version 6.1.0-18-amd64 (x) #1 SMP PREEMPT_DYNAMIC Debian");
  expect("kernel", Verdict::kWarn, "6.1.0-18-amd64");
  put("sys/kernel/realtime", "1\n");
  EXPECT_EQ(finding("kernel").verdict, Verdict::kOk);
}

TEST_F(RealTime, PriorityIsComparedWithWhatTheConfigurationWants) {
  limits("10", "unlimited");
  expect("rtprio", Verdict::kWarn, "up to 10, wanted 50");
  Needs modest;
  modest.fifo_priority = 10;
  expect("rtprio", Verdict::kOk, "10", modest);
  modest.fifo_priority = 0;
  expect("rtprio", Verdict::kOk, "none is wanted", modest);
  put("proc/self/status", "CapEff:\t0000000000800000\n");
  expect("rtprio", Verdict::kOk, "CAP_SYS_NICE");
}

TEST_F(RealTime, LockedMemory) {
  limits("95", "8388608");
  expect("memlock", Verdict::kWarn, "8 MB, wanted 512 MB");
  limits("95", "1073741824");
  expect("memlock", Verdict::kOk, "1024 MB");
  limits("95", "8388608");
  Needs none;
  none.lock_memory = false;
  expect("memlock", Verdict::kOk, "none is wanted", none);
  put("proc/self/status", "CapEff:\t0000000000004000\n");
  expect("memlock", Verdict::kOk, "CAP_IPC_LOCK");
}

TEST_F(RealTime, Throttling) {
  put("proc/sys/kernel/sched_rt_runtime_us", "500000\n");
  expect("throttling", Verdict::kWarn, "500000 of 1000000");
  put("proc/sys/kernel/sched_rt_runtime_us", "0\n");
  EXPECT_EQ(finding("throttling").verdict, Verdict::kWarn);
  put("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
  expect("throttling", Verdict::kOk, "none");
}

TEST_F(RealTime, GovernorOfAnyProcessor) {
  put(cpu("cpu3/cpufreq/scaling_governor"), "powersave\n");
  expect("governor", Verdict::kWarn, "performance, powersave");
  remove(cpu("cpu3"));
  remove(cpu("cpu0/cpufreq"));
  expect("governor", Verdict::kOk, "does not change");
}

TEST_F(RealTime, DeepIdleStatesThatAreOn) {
  put(cpu("cpu0/cpuidle/state2/latency"), "350\n");
  expect("idle", Verdict::kWarn, "350 us");
  put(cpu("cpu0/cpuidle/state2/disable"), "1\n");
  expect("idle", Verdict::kOk, "2 us");
}

TEST_F(RealTime, IsolationOfTheProcessorThatIsNamed) {
  Needs needs;
  needs.cpu = 2;
  expect("isolcpus", Verdict::kWarn, "2 of loop.cpu is not isolated", needs);
  put(cpu("isolated"), "2-3\n");
  expect("isolcpus", Verdict::kOk, "is isolated", needs);
  expect("isolcpus", Verdict::kWarn, "2-3 are isolated");
  needs.cpu = 4;
  expect("isolcpus", Verdict::kFail, "which this machine does not have", needs);
}

TEST_F(RealTime, SlowClock) {
  put(kClock, "hpet\n");
  expect("clock", Verdict::kWarn, "hpet");
}

TEST_F(RealTime, ProcessorThatLacksInstructions) {
  put("proc/cpuinfo", "flags : fpu sse2 avx fma bmi1 f16c movbe abm\n");
  const Finding found = finding("cpu");
  if (found.found.find("built for") == 0) GTEST_SKIP() << "not a build for x86-64-v3";
  expect("cpu", Verdict::kFail, "lacks avx2, bmi2");
}

TEST(CpuList, IsReadAsTheKernelWritesIt) {
  EXPECT_EQ(cpu_list("0-2,5"), (std::vector<int>{0, 1, 2, 5}));
  EXPECT_EQ(cpu_list("7"), std::vector<int>{7});
  EXPECT_TRUE(cpu_list("").empty());
  EXPECT_TRUE(cpu_list("(null)").empty());
  EXPECT_EQ(cpu_list("1,x"), std::vector<int>{1});
}

}  // namespace
}  // namespace palpate::doctor
