// Records left by the daemon after a fault or crash, and its reports to the service manager.

#include <algorithm>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <palpate/robot_state_t.hpp>

#include "tests/process/daemon/daemon_process.hpp"
#include "tests/process/supervision/loop_thread.hpp"
#include "tests/support/notify_socket.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;
using support::ChildProcess;

template <class Condition>
bool wait_until(Condition condition) {
  const auto end = steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (steady_clock::now() > end) return false;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return true;
}

/// Contents of a log, by liblcm's own reader.
struct LogContent {
  std::map<std::string, int> messages;  // by channel
  double duration = 0;                  // s
};

LogContent content_of(const fs::path& path) {
  LogContent content;
  lcm::LogFile log(path.string(), "r");
  std::int64_t first = 0, last = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (content.messages.empty()) first = event->timestamp;
    last = event->timestamp;
    ++content.messages[event->channel];
  }
  content.duration = static_cast<double>(last - first) * 1e-6;
  return content;
}

class Supervision : public DaemonProcess {
 protected:
  std::vector<fs::path> records() const {
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder_.path())) paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    return paths;
  }
  std::vector<std::string> recording_command() const {
    return command({"--set", "record.folder=" + folder_.path().string(), "--set",
                    "record.seconds=0.5", "--set", "record.keep=2"});
  }
  void send_robot_states(int count) {
    bus::TypedPublisher<robot_state_t> publisher(*control_, "ROBOT_STATE");
    robot_state_t state{};
    state.session = 7;
    state.joint_count = 7;
    state.quaternion[0] = 1;
    for (int i = 0; i < count; ++i) {
      state.seq = ++sent_;
      state.utime = 2000 * sent_;
      publisher.publish(state);
      std::this_thread::sleep_for(milliseconds(2));
    }
  }
  void expect_full_record(const fs::path& path, const std::string& log) {
    const LogContent content = content_of(path);
    const auto count = [&](const char* channel) {
      return content.messages.count(channel) == 0 ? 0 : content.messages.at(channel);
    };
    EXPECT_GT(count("ROBOT_STATE"), 10);
    // Of 500 cycles in half a second, if the machine is busy.
    EXPECT_GT(count("TWIST_COMMAND"), 100 / PALPATE_SLOWNESS);
    // A crash may occur within a cycle.
    EXPECT_NEAR(count("TWIST_COMMAND"), count("ESTIMATE"), 1);
    EXPECT_LE(content.duration, 0.5);
    EXPECT_NE(log.find(path.string()), std::string::npos) << "the log names the record\n" << log;
  }
  bool started_with_robot(ChildProcess& daemon) {
    health_t health;
    if (!wait_health([](const health_t& h) { return h.cycles > 200; }, health)) return false;
    send_event("start", 1);
    send_robot_states(100);
    return daemon.running();
  }

  support::ScratchFolder folder_;
  int sent_ = 0;
};

TEST_F(Supervision, ALatchedFaultLeavesARecordThatReplays) {
  ChildProcess daemon(recording_command());
  ASSERT_TRUE(started_with_robot(daemon)) << daemon.output();
  // Too long without a command.
  daemon.send(SIGSTOP);
  std::this_thread::sleep_for(milliseconds(300));
  daemon.send(SIGCONT);
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.state == 4; }, health));
  ASSERT_TRUE(wait_until([&] { return !records().empty(); })) << daemon.output();
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(milliseconds(20000)), 0);
  ASSERT_EQ(records().size(), 1u);
  const fs::path record = records()[0];
  EXPECT_NE(record.filename().string().find("-fault.lcmlog"), std::string::npos) << record;
  expect_full_record(record, daemon.output());

  ChildProcess replay({std::string(PALPATE_BIN_DIR) + "/palpate-replay", record.string(),
                       "--config", kExample, "--start"});
  EXPECT_EQ(replay.wait(milliseconds(60000)), 0) << replay.output();
}

TEST_F(Supervision, ACrashLeavesARecordAndEndsAsItWould) {
  for (const int signal : {SIGSEGV, SIGABRT}) {
    const std::size_t before = records().size();
    ChildProcess daemon(recording_command());
    ASSERT_TRUE(started_with_robot(daemon)) << daemon.output();
    daemon.send(signal);
    EXPECT_EQ(daemon.wait(milliseconds(20000)), 128 + signal);
    ASSERT_EQ(records().size(), before + 1);
    EXPECT_NE(records().back().filename().string().find("-crash.lcmlog"), std::string::npos);
    expect_full_record(records().back(), daemon.output());
    health_t stale;
    std::int64_t arrival_ns = 0;
    while (health_->take(stale, arrival_ns)) {
    }
  }
}

TEST_F(Supervision, ARecordIsWrittenOnRequestAndOldOnesGo) {
  ChildProcess daemon(recording_command());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health));
  std::vector<fs::path> last;
  for (int i = 0; i < 4; ++i) {
    send_robot_states(50);
    daemon.send(SIGUSR1);
    ASSERT_TRUE(wait_until([&] { return !records().empty() && records() != last; })) << i;
    // The file is complete once the log names it.
    ASSERT_TRUE(wait_until(
        [&] { return daemon.output().find(records().back().string()) != std::string::npos; }));
    last = records();
  }
  EXPECT_EQ(records().size(), 2u);
  EXPECT_TRUE(daemon.running());
  expect_full_record(records().back(), daemon.output());
}

TEST_F(Supervision, AFolderThatCannotBeWrittenIsNamedAtTheStart) {
  ChildProcess daemon(command({"--set", "record.folder=/proc/nowhere"}));
  EXPECT_EQ(daemon.wait(milliseconds(20000)), 1);
  EXPECT_NE(daemon.output().find("/proc/nowhere"), std::string::npos) << daemon.output();
}

TEST_F(Supervision, PingsStopWhenTheLoopHangsAndGoOnWithIt) {
  support::NotifySocket socket;
  setenv("NOTIFY_SOCKET", socket.name().c_str(), 1);
  setenv("WATCHDOG_USEC", "200000", 1);
  ChildProcess daemon(command());
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");

  std::vector<std::string> messages;
  const auto wait_for = [&](const char* text, int times) {
    return wait_until([&] {
      for (const std::string& message : socket.take()) messages.push_back(message);
      return std::count(messages.begin(), messages.end(), text) >= times;
    });
  };
  ASSERT_TRUE(wait_for("READY=1", 1)) << daemon.output();
  ASSERT_TRUE(wait_for("WATCHDOG=1", 3));
  EXPECT_LT(std::find(messages.begin(), messages.end(), "READY=1"),
            std::find(messages.begin(), messages.end(), "WATCHDOG=1"));

  HeldThread loop(daemon.pid(), "palpated-loop");
  ASSERT_TRUE(loop.found());
  if (!loop.held()) GTEST_SKIP() << "this system does not let a test hold a thread";
  // The supervising thread is still alive and detects it.
  ASSERT_TRUE(wait_until(
      [&] { return daemon.output().find("the loop does not move") != std::string::npos; }));
  socket.take();
  std::this_thread::sleep_for(milliseconds(600));
  EXPECT_TRUE(socket.take().empty()) << "three intervals without a ping";
  loop.release();
  messages.clear();
  EXPECT_TRUE(wait_for("WATCHDOG=1", 3));
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(milliseconds(20000)), 0);
  EXPECT_TRUE(wait_for("STOPPING=1", 1));
}

TEST_F(Supervision, EndsSoonOnSigtermWithAZeroCommandLast) {
  std::vector<double> took;
  for (int i = 0; i < 10; ++i) {
    ChildProcess daemon(command());
    ASSERT_TRUE(wait_until([&] {
      twist_command_t twist;
      std::int64_t arrival_ns = 0;
      return twist_->take(twist, arrival_ns);
    })) << daemon.output();
    send_event("start", i + 1);
    std::this_thread::sleep_for(milliseconds(50));
    const auto asked = steady_clock::now();
    daemon.send(SIGTERM);
    ASSERT_EQ(daemon.wait(milliseconds(20000)), 0) << daemon.output();
    took.push_back(std::chrono::duration<double, std::milli>(steady_clock::now() - asked).count());
    std::this_thread::sleep_for(milliseconds(20));
    twist_command_t last;
    std::int64_t arrival_ns = 0;
    bool any = false;
    while (twist_->take(last, arrival_ns)) any = true;
    ASSERT_TRUE(any);
    EXPECT_EQ(last.valid, 0);
    for (double v : last.twist) EXPECT_EQ(v, 0);
  }
  std::sort(took.begin(), took.end());
  std::printf("SIGTERM to exit: median %.0f ms, longest of %zu %.0f ms (500 ms wanted)\n",
              took[took.size() / 2], took.size(), took.back());
}

}  // namespace
}  // namespace palpate
