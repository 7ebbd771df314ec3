#include <algorithm>
#include <set>

#include "tools/doctor/checks.hpp"

namespace palpate::doctor {
namespace {

constexpr char kCpu[] = "sys/devices/system/cpu";
constexpr int kIpcLock = 14, kSysNice = 23;  // capabilities
constexpr std::int64_t kMemory =
    512 << 20;  // bytes, upper bound of palpated's locked memory, with a margin
constexpr std::int64_t kIdleLatency = 60;  // us
constexpr char kLimits[] =
    "printf '@realtime - rtprio 99\\n@realtime - memlock unlimited\\n' | sudo tee "
    "/etc/security/limits.d/palpate.conf\n"
    "sudo groupadd -f realtime && sudo usermod -aG realtime $USER   # then log in again";

Finding check_kernel(const Machine& machine) {
  const std::string version = machine.read("proc/version").value_or("");
  if (machine.number("sys/kernel/realtime").value_or(0) == 1 ||
      version.find("PREEMPT_RT") != std::string::npos)
    return ok("kernel", "PREEMPT_RT");
  const std::vector<std::string> words = words_of(version);
  return warn("kernel", (words.size() > 2 ? words[2] : "a kernel") + " without PREEMPT_RT",
              "the loop wakes up late, by milliseconds at times: overruns, and a safe stop after "
              "20 ms",
              "sudo apt-get install linux-image-rt-amd64   # then reboot into it");
}

bool has_capability(const Machine& machine, int bit) {
  for (const std::string& line : machine.lines("proc/self/status")) {
    const std::vector<std::string> words = words_of(line);
    if (words.size() == 2 && words[0] == "CapEff:")
      return (std::strtoull(words[1].c_str(), nullptr, 16) >> bit & 1) != 0;
  }
  return false;
}

/// The soft limit; -1: unlimited; empty if it is not given.
std::optional<std::int64_t> limit(const Machine& machine, const std::string& label) {
  for (const std::string& line : machine.lines("proc/self/limits")) {
    if (line.rfind(label, 0) != 0) continue;
    const std::vector<std::string> words = words_of(line.substr(label.size()));
    if (words.empty()) return std::nullopt;
    if (words[0] == "unlimited") return -1;
    return std::strtoll(words[0].c_str(), nullptr, 10);
  }
  return std::nullopt;
}

Finding check_priority(const Machine& machine, const Needs& needs) {
  const std::string wanted = std::to_string(needs.fifo_priority);
  if (needs.fifo_priority == 0) return ok("rtprio", "loop.fifo_priority is 0: none is wanted");
  if (has_capability(machine, kSysNice)) return ok("rtprio", "any (CAP_SYS_NICE)");
  const std::int64_t granted = limit(machine, "Max realtime priority").value_or(0);
  if (granted < 0 || granted >= needs.fifo_priority)
    return ok("rtprio",
              (granted < 0 ? "any" : std::to_string(granted)) + " (wanted " + wanted + ")");
  return warn("rtprio", "up to " + std::to_string(granted) + ", wanted " + wanted,
              "without SCHED_FIFO any program on the machine can hold up the loop", kLimits);
}

Finding check_locked_memory(const Machine& machine, const Needs& needs) {
  if (!needs.lock_memory) return ok("memlock", "loop.lock_memory is false: none is wanted");
  if (has_capability(machine, kIpcLock)) return ok("memlock", "any (CAP_IPC_LOCK)");
  const std::int64_t granted = limit(machine, "Max locked memory").value_or(0);
  const std::string text = granted < 0 ? "unlimited" : std::to_string(granted / (1 << 20)) + " MB";
  if (granted < 0 || granted >= kMemory) return ok("memlock", text);
  return warn("memlock", text + ", wanted " + std::to_string(kMemory / (1 << 20)) + " MB",
              "memory that is not locked may be paged out: the loop waits for the disk", kLimits);
}

Finding check_throttling(const Machine& machine) {
  const std::int64_t runtime =
      machine.number("proc/sys/kernel/sched_rt_runtime_us").value_or(950'000);
  const std::int64_t period =
      machine.number("proc/sys/kernel/sched_rt_period_us").value_or(1'000'000);
  const std::string text =
      std::to_string(runtime) + " of " + std::to_string(period) + " us for real-time threads";
  if (runtime < 0) return ok("throttling", "none");
  if (runtime * 100 >= 90 * period) return ok("throttling", text);
  return warn("throttling", text, "the kernel stops the loop for the rest of each period",
              "sudo sysctl -w kernel.sched_rt_runtime_us=950000");
}

Finding check_governor(const Machine& machine) {
  std::set<std::string> governors;
  for (const std::string& name : machine.list(kCpu)) {
    const auto governor =
        machine.read(std::string(kCpu) + "/" + name + "/cpufreq/scaling_governor");
    if (governor) governors.insert(*governor);
  }
  if (governors.empty()) return ok("governor", "the system does not change the frequency");
  std::string all;
  for (const std::string& one : governors) all += (all.empty() ? "" : ", ") + one;
  if (governors == std::set<std::string>{"performance"}) return ok("governor", all);
  return warn("governor", all, "a processor that slows down between two cycles is late in the next",
              "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor");
}

Finding check_idle(const Machine& machine) {
  std::int64_t longest = 0;
  const std::string folder = std::string(kCpu) + "/cpu0/cpuidle";
  for (const std::string& state : machine.list(folder)) {
    if (machine.number(folder + "/" + state + "/disable").value_or(0) != 0) continue;
    longest = std::max(longest, machine.number(folder + "/" + state + "/latency").value_or(0));
  }
  const std::string text =
      "wake-up from the deepest idle state takes " + std::to_string(longest) + " us";
  if (longest <= kIdleLatency) return ok("idle", text);
  return warn("idle", text, "each cycle begins that much late where a processor was idle",
              "sudo cpupower idle-set -D " + std::to_string(kIdleLatency) +
                  "   # of the package linux-cpupower");
}

Finding check_isolation(const Machine& machine, const Needs& needs) {
  const std::string isolated = machine.read(std::string(kCpu) + "/isolated").value_or("");
  const std::vector<int> apart = cpu_list(isolated);
  if (needs.cpu < 0) {
    if (apart.empty()) return ok("isolcpus", "loop.cpu names no processor, none is isolated");
    return warn(
        "isolcpus", "processors " + isolated + " are isolated, loop.cpu names none",
        "nothing runs on an isolated processor unless assigned to it: palpated shares the others",
        "set loop.cpu: " + std::to_string(apart.front()) + " in the configuration");
  }
  const std::string cpu = std::to_string(needs.cpu);
  const std::vector<int> online =
      cpu_list(machine.read(std::string(kCpu) + "/online").value_or(""));
  if (!online.empty() && std::find(online.begin(), online.end(), needs.cpu) == online.end())
    return fail("isolcpus", "loop.cpu is " + cpu + ", which this machine does not have",
                "palpated is not bound to any processor",
                "set loop.cpu to one of " + machine.read(std::string(kCpu) + "/online").value());
  if (std::find(apart.begin(), apart.end(), needs.cpu) != apart.end())
    return ok("isolcpus", "processor " + cpu + " of loop.cpu is isolated");
  return warn("isolcpus", "processor " + cpu + " of loop.cpu is not isolated",
              "other programs run there as well, and palpated cannot move away from them",
              "add isolcpus=" + cpu + " nohz_full=" + cpu + " rcu_nocbs=" + cpu +
                  " to GRUB_CMDLINE_LINUX in /etc/default/grub\nsudo update-grub   # then reboot");
}

Finding check_clock(const Machine& machine) {
  const std::string folder = "sys/devices/system/clocksource/clocksource0/";
  const std::string source = machine.read(folder + "current_clocksource").value_or("");
  const std::set<std::string> fast = {"tsc", "kvm-clock", "arch_sys_counter",
                                      "hyperv_clocksource_tsc_page", "xen"};
  if (source.empty()) return warn("clock", "not reported by the kernel", "", "");
  if (fast.count(source) > 0) return ok("clock", source);
  return warn("clock", source, "each reading of the time costs a microsecond or more",
              "echo tsc | sudo tee /" + folder +
                  "current_clocksource   # where dmesg | grep -i tsc "
                  "says nothing against it");
}

Finding check_instructions(const Machine& machine) {
  const std::string march = PALPATE_MARCH;
  if (march != "x86-64-v3")
    return ok("cpu", "built for " + (march.empty() ? std::string("any processor") : march));
  std::set<std::string> flags;
  for (const std::string& line : machine.lines("proc/cpuinfo")) {
    if (line.rfind("flags", 0) != 0) continue;
    for (const std::string& flag : words_of(line)) flags.insert(flag);
    break;
  }
  std::string missing;
  for (const char* flag : {"avx2", "fma", "bmi1", "bmi2", "f16c", "movbe", "abm"}) {
    if (flags.count(flag) == 0) missing += (missing.empty() ? "" : ", ") + std::string(flag);
  }
  if (missing.empty()) return ok("cpu", "has what x86-64-v3 names");
  return fail("cpu", "lacks " + missing, "programs built for x86-64-v3 end with SIGILL here",
              "cmake --preset release -DPALPATE_MARCH=x86-64 && cmake --build build/release");
}

}  // namespace

Findings check_real_time(const Machine& machine, const Needs& needs) {
  return {check_kernel(machine),
          check_priority(machine, needs),
          check_locked_memory(machine, needs),
          check_throttling(machine),
          check_governor(machine),
          check_idle(machine),
          check_isolation(machine, needs),
          check_clock(machine),
          check_instructions(machine)};
}

}  // namespace palpate::doctor
