#include <gtest/gtest.h>

#include <cmath>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "rt/bus/message_bus.hpp"
#include "rt/daemon/text.hpp"
#include "tests/support/child_process.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using support::ChildProcess;

const std::string kDaemon = std::string(PALPATE_BIN_DIR) + "/palpated";
const std::string kExample =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml";

/// A daemon on private URLs and both ends of them.
class DaemonProcess : public ::testing::Test {
 protected:
  std::vector<std::string> command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {kDaemon, kExample,
                                      "--set", "bus.control=" + control_url_,
                                      "--set", "bus.housekeeping=" + housekeeping_url_};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  void SetUp() override {
    try {
      control_ = bus::make_lcm_bus(control_url_);
      housekeeping_ = bus::make_lcm_bus(housekeeping_url_);
    } catch (const std::runtime_error& error) {
      GTEST_SKIP() << error.what();
    }
    health_ = std::make_unique<bus::TypedSubscription<health_t>>(*housekeeping_, "HEALTH", 8);
    twist_ =
        std::make_unique<bus::TypedSubscription<twist_command_t>>(*control_, "TWIST_COMMAND", 64);
    control_->start();
    housekeeping_->start();
  }

  void TearDown() override {
    if (control_) control_->stop();
    if (housekeeping_) housekeeping_->stop();
  }

  /// The newest HEALTH that fulfils `condition`, waited for at most 20 s.
  template <class Condition>
  bool wait_health(Condition condition, health_t& health) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    std::int64_t arrival_ns = 0;
    while (std::chrono::steady_clock::now() < end) {
      while (health_->take(health, arrival_ns)) {
        if (condition(health)) return true;
      }
      std::this_thread::sleep_for(milliseconds(5));
    }
    return false;
  }

  void send_event(const char* event, std::int64_t counter) {
    component_command_t message{};
    message.session = 42;
    message.counter = counter;
    daemon::put_text(message.slot, "all");
    daemon::put_text(message.event, event);
    bus::TypedPublisher<component_command_t>(*control_, "COMPONENT_COMMAND").publish(message);
  }

  std::string control_url_ = support::private_url(0);
  std::string housekeeping_url_ = support::private_url(1);
  std::unique_ptr<bus::MessageBus> control_;
  std::unique_ptr<bus::MessageBus> housekeeping_;
  std::unique_ptr<bus::TypedSubscription<health_t>> health_;
  std::unique_ptr<bus::TypedSubscription<twist_command_t>> twist_;
};

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
