#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/scratch_folder.hpp"
#include "tools/doctor/checks.hpp"

namespace palpate::doctor {

/// A fictitious machine on which all is well, and of which a test changes one thing.
class Tree : public testing::Test {
 protected:
  Tree() {
    put("proc/version", "Linux version 6.1.0-rt (x) #1 SMP PREEMPT_RT Debian");
    limits("95", "unlimited");
    put("proc/self/status", "Name:\tdoctor\nCapEff:\t0000000000000000\n");
    put("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
    put("proc/sys/kernel/sched_rt_period_us", "1000000\n");
    put("proc/cpuinfo", "processor : 0\nflags : fpu sse2 avx avx2 fma bmi1 bmi2 f16c movbe abm\n");
    put(cpu("cpu0/cpufreq/scaling_governor"), "performance\n");
    put(cpu("cpu0/cpuidle/state0/latency"), "0\n");
    put(cpu("cpu0/cpuidle/state1/latency"), "2\n");
    put(cpu("online"), "0-3\n");
    put(cpu("isolated"), "\n");
    put(kClock, "tsc\n");
    put("proc/sys/net/core/rmem_max", "16777216\n");
    route("lo 000000E0 00000000 0001 0 0 0 000000F0 0 0 0");
    put("sys/class/net/lo/flags", "0x1009\n");
    put("proc/net/udp", kUdpHeader);
    put("proc/net/unix", "Num RefCount Protocol Flags Type St Inode Path\n");
    put("var/lib/dpkg/status",
        "Package: liblcm1\nStatus: install ok installed\nVersion: 1.3.1+repack1-3\n\n");
    put(kBlas + "openblas-pthread/libblas.so.3", "");
    link(kBlas + "libblas.so.3", "/etc/alternatives/libblas.so.3-x86_64-linux-gnu");
    link("etc/alternatives/libblas.so.3-x86_64-linux-gnu",
         "/" + kBlas + "openblas-pthread/libblas.so.3");
    put("usr/lib/jvm/java-17/bin/java", "");
    put("usr/lib/jvm/java-17/lib/libawt_xawt.so", "");
    put("usr/lib/jvm/java-17/release", "JAVA_VERSION=\"17.0.15\"\n");
    link("usr/bin/java", "/etc/alternatives/java");
    link("etc/alternatives/java", "/usr/lib/jvm/java-17/bin/java");
    put("usr/share/java/lcm.jar", "");
    put("usr/share/java/jchart2d.jar", "");
    put("opt/palpate-spy.jar", "");
  }

  static constexpr char kClock[] =
      "sys/devices/system/clocksource/clocksource0/current_clocksource";
  static constexpr char kUdpHeader[] =
      "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout "
      "inode ref pointer drops\n";

  inline static const std::string kBlas = "usr/lib/x86_64-linux-gnu/";

  static std::string cpu(const std::string& path) { return "sys/devices/system/cpu/" + path; }
  void put(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((folder_.path() / path).parent_path());
    std::ofstream(folder_.path() / path) << text;
  }
  void remove(const std::string& path) const { std::filesystem::remove_all(folder_.path() / path); }
  void link(const std::string& path, const std::string& target) const {
    std::filesystem::create_directories((folder_.path() / path).parent_path());
    remove(path);
    std::filesystem::create_symlink(target, folder_.path() / path);
  }
  void limits(const std::string& priority, const std::string& memory) const {
    put("proc/self/limits",
        "Limit                     Soft Limit           Hard Limit           Units\n"
        "Max locked memory         " +
            memory + "              " + memory + "     bytes\n" + "Max realtime priority     " +
            priority + "                    95\n");
  }
  void route(const std::string& line) const {
    put("proc/net/route",
        "Iface Destination Gateway Flags RefCnt Use Metric Mask MTU Window IRTT\n" + line + "\n");
  }
  /// A socket of a process on a port; `state` as in /proc.
  void listener(int pid, const std::string& name, const std::string& address_and_port, int drops,
                const std::string& state = "S (sleeping)") const {
    const std::string inode = std::to_string(1000 + pid);
    std::ofstream(folder_.path() / "proc/net/udp", std::ios::app)
        << "  1: " << address_and_port
        << " 00000000:0000 07 00000000:00000000 00:00000000 00000000 "
        << "    0        0 " << inode << " 2 0000000000000000 " << drops << "\n";
    const std::string folder = "proc/" + std::to_string(pid);
    put(folder + "/comm", name + "\n");
    put(folder + "/status", "Name:\t" + name + "\nState:\t" + state + "\n");
    link(folder + "/fd/5", "socket:[" + inode + "]");
  }

  Machine machine() const { return Machine(folder_.path()); }
  Findings all(const Needs& needs = {}) const {
    Findings findings = check_real_time(machine(), needs);
    for (const Findings& more :
         {check_network(machine(), needs), check_programs(machine(), "opt/palpate-spy.jar")})
      findings.insert(findings.end(), more.begin(), more.end());
    return findings;
  }
  /// The finding of one check, which must exist exactly once.
  Finding finding(const std::string& check, const Needs& needs = {}) const {
    Finding found;
    int count = 0;
    for (const Finding& one : all(needs)) {
      if (one.check != check) continue;
      found = one;
      ++count;
    }
    EXPECT_EQ(count, 1) << check;
    return found;
  }
  /// Expects this verdict, a text with `words`, and, unless all is well, a reason and a fix.
  void expect(const std::string& check, Verdict verdict, const std::string& words,
              const Needs& needs = {}) const {
    const Finding found = finding(check, needs);
    EXPECT_EQ(found.verdict, verdict) << check << ": " << found.found;
    EXPECT_NE(found.found.find(words), std::string::npos) << found.found;
    EXPECT_EQ(found.why.empty(), verdict == Verdict::kOk) << check;
    EXPECT_EQ(found.remedy.empty(), verdict == Verdict::kOk) << check;
    // The other checks are unaffected.
    for (const Finding& one : all(needs)) {
      if (one.check != check) {
        EXPECT_EQ(one.verdict, Verdict::kOk) << one.check << ": " << one.found;
      }
    }
  }

 private:
  support::ScratchFolder folder_;
};

}  // namespace palpate::doctor
