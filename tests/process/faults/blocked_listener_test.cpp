// Receivers may stop reading: full sockets, full disks, a log that is not read.

#include <fcntl.h>

#include <filesystem>

#include "tests/process/faults/fault_process.hpp"

namespace palpate {
namespace {

class BlockedListener : public FaultProcess {
 protected:
  void begin(ChildProcess& daemon) {
    health_t health{};
    ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
        << daemon.output();
    robot_ = std::make_unique<Robot>(control_url_, true);
    ASSERT_TRUE(activate()) << daemon.output();
    send_target();
    watch_for(1);
  }
  std::unique_ptr<Robot> robot_;
};

/// A stopped logger's sockets fill up: only the logger loses messages.
TEST_F(BlockedListener, StoppedLoggerIsNotWaitedFor) {
  ChildProcess daemon(patient_command());
  ASSERT_NO_FATAL_FAILURE(begin(daemon));
  const auto log = [](const char* name) {
    return (std::filesystem::temp_directory_path() /
            ("palpate_test_" + std::to_string(getpid()) + name))
        .string();
  };
  const std::string control_log = log("_control.log"), housekeeping_log = log("_housekeeping.log");
  if (!std::filesystem::exists("/usr/bin/lcm-logger")) GTEST_SKIP() << "lcm-logger is absent";
  {
    ChildProcess control(
        {"/usr/bin/lcm-logger", "-q", "-f", "--lcm-url=" + control_url_, control_log});
    ChildProcess housekeeping(
        {"/usr/bin/lcm-logger", "-q", "-f", "--lcm-url=" + housekeeping_url_, housekeeping_log});
    watch_for(5);  // to the target
    const Seen logged = watch_for(2);
    ASSERT_TRUE(control.running() && housekeeping.running());
    control.send(SIGSTOP);
    housekeeping.send(SIGSTOP);
    const Seen stopped = watch_for(amount("PALPATE_STOPPED_SECONDS", 4));
    print("logged", logged);
    print("stopped", stopped);
    EXPECT_GT(stopped.commands / stopped.seconds, 0.25 * logged.commands / logged.seconds);
    EXPECT_LE(stopped.rms_error, 2 * logged.rms_error + 1e-3);
    EXPECT_EQ(stopped.not_finite, 0);
  }
  const health_t health = health_now();
  EXPECT_TRUE(health.state == 2 || health.state == 3) << bus::get_text(health.reason);
  std::filesystem::remove(control_log);
  std::filesystem::remove(housekeeping_log);
}

/// A full disk under the log.
TEST_F(BlockedListener, FullDiskUnderTheLogIsNoFault) {
  std::string line = "exec";
  for (const std::string& word : patient_command()) line += " '" + word + "'";
  ChildProcess daemon({"/bin/sh", "-c", line + " > /dev/full 2>&1"});
  ASSERT_NO_FATAL_FAILURE(begin(daemon));
  const Seen seen = watch_for(1);
  EXPECT_GT(seen.commands, 0);
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(milliseconds(10000)), 0);
}

/// A full pipe as the log's destination, like that of a hung journal.
TEST_F(BlockedListener, BlockedLogHoldsUpNeitherLoopNorEnd) {
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  ASSERT_EQ(fcntl(ends[1], F_SETFL, O_NONBLOCK), 0);
  const std::vector<char> filler(4096, '.');
  while (write(ends[1], filler.data(), filler.size()) > 0) {
  }
  ASSERT_EQ(fcntl(ends[1], F_SETFL, 0), 0);
  const std::string target = "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(ends[1]);
  std::string line = "exec";
  for (const std::string& word : patient_command()) line += " '" + word + "'";
  ChildProcess daemon({"/bin/sh", "-c", line + " > " + target + " 2>&1"});
  ASSERT_NO_FATAL_FAILURE(begin(daemon));
  const Seen seen = watch_for(1);
  EXPECT_GT(seen.commands, 0);
  const auto asked = Clock::now();
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(milliseconds(10000)), 0);
  std::printf("ended after %.3f s\n", seconds_since(asked));
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace palpate
