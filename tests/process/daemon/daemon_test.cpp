#include <cmath>
#include <palpate/robot_state_t.hpp>

#include "tests/process/daemon/daemon_process.hpp"

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

TEST_F(DaemonProcess, ConfigurationErrorsExitWith78AndNameTheKey) {
  struct Case {
    const char* override_text;
    const char* expected;
  };
  for (const Case& wrong :
       {Case{"object.mesh={file: nowhere.msh}", "nowhere.msh"},
        Case{"estimation.component=magic", "magic"}, Case{"loop.period_ms=-1", "period_ms"},
        Case{"gate.linear_spede=1", "linear_spede"}}) {
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
