#include <cmath>
#include <filesystem>
#include <palpate/robot_state_t.hpp>

#include "tests/process/daemon/daemon_process.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using support::ChildProcess;

TEST_F(DaemonProcess, StartsInactiveWithZeroCommandAndEndsOnSigterm) {
  ChildProcess daemon(command());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
      << daemon.output();
  EXPECT_EQ(health.state, 1);
  twist_command_t twist;
  std::int64_t arrival_ns = 0;
  int commands = 0;
  while (twist_->take(twist, arrival_ns)) {
    ++commands;
    EXPECT_EQ(twist.valid, 0);
    for (double v : twist.twist) EXPECT_EQ(v, 0);
  }
  EXPECT_GT(commands, 0);
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(milliseconds(10000)), 0) << daemon.output();
}

// CHOLMOD and its BLAS have no threads, which would exist after the first factor at the latest.
TEST_F(DaemonProcess, HasTheSameThreadsWithEitherFactor) {
  std::int64_t session = 0;
  std::vector<std::ptrdiff_t> threads;
  for (const std::vector<std::string>& more :
       {std::vector<std::string>(), {"--set", "deformation.factor=own"}}) {
    ChildProcess daemon(command(more));
    health_t health{};
    ASSERT_TRUE(wait_health(
        [session](const health_t& h) { return h.session != session && h.cycles > 200; }, health))
        << daemon.output();
    session = health.session;
    const std::filesystem::directory_iterator tasks("/proc/" + std::to_string(daemon.pid()) +
                                                    "/task");
    threads.push_back(std::distance(begin(tasks), end(tasks)));
    daemon.send(SIGTERM);
    EXPECT_EQ(daemon.wait(milliseconds(10000)), 0) << daemon.output();
  }
  EXPECT_EQ(threads[0], threads[1]);
}

TEST_F(DaemonProcess, ConfigurationErrorsExitWith78AndNameTheKey) {
  struct Case {
    const char* override_text;
    const char* expected;
  };
  for (const Case& wrong :
       {Case{"object.mesh={file: nowhere.msh}", "nowhere.msh"},
        Case{"estimation.component=magic", "magic"}, Case{"loop.period_ms=-1", "period_ms"},
        Case{"gate.linear_spede=1", "linear_spede"},
        Case{"bus.control=udpm://10.0.0.1:7667", "10.0.0.1 is not a multicast address"}}) {
    ChildProcess daemon(command({"--set", wrong.override_text}));
    EXPECT_EQ(daemon.wait(milliseconds(20000)), 78) << wrong.override_text;
    EXPECT_NE(daemon.output().find(wrong.expected), std::string::npos) << daemon.output();
  }
}

TEST_F(DaemonProcess, SecondDaemonOnTheSameUrlIsRefused) {
  ChildProcess first(command());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 0; }, health));
  ChildProcess second(command());
  EXPECT_EQ(second.wait(milliseconds(20000)), 1);
  EXPECT_NE(second.output().find(control_url_), std::string::npos) << second.output();
  EXPECT_TRUE(first.running());
}

TEST_F(DaemonProcess, AWrongConfigurationIsNamedBeforeAnotherDaemon) {
  ChildProcess first(command());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 0; }, health));
  ChildProcess second(command({"--set", "control.provider=magic"}));
  EXPECT_EQ(second.wait(milliseconds(20000)), 78);
  EXPECT_NE(second.output().find("magic"), std::string::npos) << second.output();
  EXPECT_EQ(second.output().find("already runs"), std::string::npos) << second.output();
  EXPECT_TRUE(first.running());
}

TEST_F(DaemonProcess, CheckEndsWith0WhereAStartWouldRunThoughAnotherDaemonRuns) {
  ChildProcess first(command());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 0; }, health));
  ChildProcess check(command({"--check"}));
  EXPECT_EQ(check.wait(milliseconds(20000)), 0) << check.output();
  EXPECT_NE(check.output().find("valid configuration"), std::string::npos) << check.output();
  ChildProcess doubtful(command({"--check", "--set", "object.grasp_box.lower=[0.46, 0.01, 0]"}));
  EXPECT_EQ(doubtful.wait(milliseconds(20000)), 0) << doubtful.output();
  EXPECT_EQ(doubtful.output().find("x = 0.46"), std::string::npos) << "the mesh is aligned";
  EXPECT_NE(doubtful.output().find("y = 0.01 m lies between rows"), std::string::npos)
      << doubtful.output();
  EXPECT_TRUE(first.running());
}

TEST_F(DaemonProcess, CheckEndsWith78AndNamesFileLineKeyValueAndRange) {
  struct Case {
    const char* text;
    std::vector<std::string> expected;
  };
  const support::ScratchFolder folder;
  const std::string file = folder.path() / "wrong.yaml";
  const std::string base = "base: " + kExample + "\n";
  for (const Case& wrong :
       {Case{"gate:\n  linear_speed: -3\n", {":3:", "gate.linear_speed", "-3", "allowed: 0"}},
        Case{"estimation:\n  component: magic\n",
             {":3:", "estimation.component", "magic", "allowed: "}},
        Case{"control:\n  gian: 2\n", {":3:", "control.gian", "allowed: "}},
        Case{"object:\n  grasp_box:\n    lower: [9, 9, 9]\n    upper: [10, 10, 10]\n",
             {"object.grasp_box", "no node"}}}) {
    std::ofstream(file) << base << wrong.text;
    ChildProcess check({kDaemon, "--check", file});
    EXPECT_EQ(check.wait(milliseconds(20000)), 78) << wrong.text;
    EXPECT_NE(check.output().find(file), std::string::npos) << check.output();
    for (const std::string& part : wrong.expected)
      EXPECT_NE(check.output().find(part), std::string::npos) << part << " in " << check.output();
  }
}

TEST_F(DaemonProcess, InvalidMessagesAreCountedAndNeverUsed) {
  ChildProcess daemon(command());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 0; }, health));
  bus::TypedPublisher<robot_state_t> publisher(*control_, "ROBOT_STATE");
  robot_state_t state{};
  state.session = 7;
  state.joint_count = 7;
  state.quaternion[0] = 1;
  state.seq = 1;
  state.position[0] = std::nan("");
  publisher.publish(state);
  state.seq = 2;
  state.position[0] = 0;
  state.quaternion[0] = 2;  // not a rotation
  publisher.publish(state);
  state.seq = 3;
  state.quaternion[0] = 1;
  state.joint_count = 17;
  publisher.publish(state);
  const char wrong_size[16] = {};
  control_->publish("ROBOT_STATE", wrong_size, sizeof wrong_size);

  constexpr int kRobot = 2;  // input index of ROBOT_STATE
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.rejected[kRobot] >= 4; }, health))
      << "rejected " << health.rejected[kRobot];
  EXPECT_EQ(health.rejected[kRobot], 4);
  EXPECT_LT(health.age_ms[kRobot], 0) << "an invalid message counts as no data";
  send_event("start", 1);
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.state != 1; }, health));
  twist_command_t twist;
  std::int64_t arrival_ns = 0;
  while (twist_->take(twist, arrival_ns)) {
    for (double v : twist.twist) EXPECT_EQ(v, 0);
  }
}

TEST_F(DaemonProcess, EveryProgramAnswersHelpAndVersion) {
  ChildProcess help({kDaemon, "--help"});
  EXPECT_EQ(help.wait(milliseconds(10000)), 0);
  EXPECT_NE(help.output().find("configuration"), std::string::npos);
  ChildProcess version({kDaemon, "--version"});
  EXPECT_EQ(version.wait(milliseconds(10000)), 0);
  EXPECT_NE(version.output().find(PALPATE_VERSION), std::string::npos);
}

}  // namespace
}  // namespace palpate
