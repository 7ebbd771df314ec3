// A daemon that is killed or crashes, and its successor.

#include <algorithm>
#include <filesystem>
#include <set>

#include "tests/process/faults/fault_process.hpp"

namespace palpate {
namespace {

/// Files and abstract sockets with our name on this machine.
std::set<std::string> remains() {
  std::set<std::string> names;
  for (const char* folder : {"/dev/shm", "/run/lock"}) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
      if (entry.path().string().find("palpate") != std::string::npos) names.insert(entry.path());
  }
  return names;
}

class Restart : public FaultProcess {
 protected:
  /// s from now until the daemon just started publishes; it must be inactive, and command zero
  /// until then and for some time after.
  double ready(Clock::time_point begin, ChildProcess& daemon) {
    health_t health{};
    std::int64_t arrival_ns = 0;
    while (health_->take(health, arrival_ns)) {
    }
    const std::int64_t former = session_;
    EXPECT_TRUE(wait_health([former](const health_t& h) { return h.session != former; }, health))
        << daemon.output();
    const double took = seconds_since(begin);
    session_ = health.session;
    EXPECT_EQ(health.state, 1) << bus::get_text(health.reason);
    Seen seen;
    twist_command_t twist{};
    const auto heard = Clock::now();
    do {
      std::this_thread::sleep_for(milliseconds(20));
      while (command_->take(twist, arrival_ns))
        if (twist.session == session_) count(twist, seen);
    } while (seen.commands == 0 && seconds_since(heard) < 5);
    EXPECT_GT(seen.commands, 0);
    EXPECT_EQ(seen.valid, 0);
    EXPECT_EQ(seen.moving, 0);
    return took;
  }

  std::vector<double> kill_and_restart(int count, int signal) {
    std::vector<double> took;
    Robot robot(control_url_, true);
    auto begin = Clock::now();
    for (int i = 0; i < count && !HasFailure(); ++i) {
      ChildProcess daemon(patient_command());
      took.push_back(ready(begin, daemon));
      // Killed while it moves the robot.
      EXPECT_TRUE(activate()) << daemon.output();
      send_target(i % 2 == 0 ? 0.08 : 0.07);
      std::this_thread::sleep_for(milliseconds(100));
      begin = Clock::now();
      daemon.send(signal);
      EXPECT_EQ(daemon.wait(milliseconds(10000)), 128 + signal);
    }
    return took;
  }

  static void report(const char* what, std::vector<double> took) {
    std::sort(took.begin(), took.end());
    std::printf("%s: %zu restarts, ready after p50 %.3f s, p99 %.3f s, max %.3f s\n", what,
                took.size(), took[took.size() / 2], took[took.size() * 99 / 100], took.back());
  }

  std::int64_t session_ = 0;
};

/// PALPATE_RESTARTS=200, or 1000, for the long run.
TEST_F(Restart, AfterKillIsInactiveAndLeavesNothing) {
  const auto before = remains();
  report("SIGKILL", kill_and_restart(amount("PALPATE_RESTARTS", 5), SIGKILL));
  EXPECT_EQ(remains(), before);
}

TEST_F(Restart, AfterACrashIsInactive) {
  if (loop::kSanitized) GTEST_SKIP() << "a sanitizer ends a crash in its own way";
  report("SIGSEGV", kill_and_restart(3, SIGSEGV));
}

}  // namespace
}  // namespace palpate
