// Programs with a key, and others without one, on one multicast group.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>
#include <palpate/component_command_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <vector>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/text.hpp"
#include "tests/support/child_process.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using support::ChildProcess;

const std::string kBin = std::string(PALPATE_BIN_DIR) + "/";
const std::string kSource = PALPATE_SOURCE_DIR;

/// Both buses, as any host on the network has them, and a key that only some have.
class AccessProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      control_ = bus::make_lcm_bus(control_url_);
      housekeeping_ = bus::make_lcm_bus(housekeeping_url_);
    } catch (const std::runtime_error& error) {
      GTEST_SKIP() << error.what();
    }
    std::string folder =
        (std::filesystem::temp_directory_path() / "palpate_access_XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
    key_file_ = folder_ / "key";
    ChildProcess make({kBin + "palpate-command", "--make-key", key_file_});
    ASSERT_EQ(make.wait(milliseconds(20000)), 0) << make.output();
    states_ = std::make_unique<bus::TypedSubscription<robot_state_t>>(*control_, "ROBOT_STATE", 64);
    twists_ =
        std::make_unique<bus::TypedSubscription<twist_command_t>>(*control_, "TWIST_COMMAND", 512);
    commands_ = std::make_unique<bus::TypedSubscription<component_command_t>>(
        *control_, "COMPONENT_COMMAND", 64);
    health_ = std::make_unique<bus::TypedSubscription<health_t>>(*housekeeping_, "HEALTH", 8);
    control_->start();
    housekeeping_->start();
  }
  void TearDown() override {
    if (control_) control_->stop();
    if (housekeeping_) housekeeping_->stop();
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::vector<std::string> driver() const {
    return {kBin + "driver_template", "--url", control_url_, "--key", key_file_};
  }
  std::vector<std::string> palpated_with(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {kBin + "palpated", "--config",
                                      kSource + "/rt/config/examples/bar_long_soft.yaml"};
    for (const std::string& value :
         {"bus.control=" + control_url_, "bus.housekeeping=" + housekeeping_url_,
          "access.key_file=" + key_file_,
          std::string("sensing=[{name: wrist, component: ft_tare_only}]")})
      words.insert(words.end(), {"--set", value});
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Runs palpate-command; returns its exit code and its output.
  int command(const std::vector<std::string>& words, std::string& said,
              bool with_key = true) const {
    std::vector<std::string> all = {kBin + "palpate-command", "--url", control_url_, "--url",
                                    "housekeeping=" + housekeeping_url_};
    if (with_key) all.insert(all.end(), {"--key", key_file_});
    all.insert(all.end(), words.begin(), words.end());
    ChildProcess program(all);
    const int code = program.wait(milliseconds(60000));
    said = program.output();
    return code;
  }

  /// Flange pose from a state that was sent after the call; waits at most 20 s for it.
  bool flange(Eigen::Vector3d& position) { return rests(position, 1e9, milliseconds(0)); }
  /// Rest pose of the flange: for this long, by the clock of its own states, it has moved by less
  /// than `within` (m; 0: bit-identical). Waits at most 20 s for it: a driver without a processor
  /// stops late.
  bool rests(Eigen::Vector3d& position, double within = 0,
             milliseconds so_long = milliseconds(400)) {
    const std::int64_t called_us = bus::wall_clock_us();
    std::int64_t since_us = 0, arrival_ns = 0;
    robot_state_t state{};
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < end) {
      while (states_->take(state, arrival_ns)) {
        if (state.utime <= called_us) continue;  // sent before, but arriving late
        const Eigen::Map<const Eigen::Vector3d> now(state.position);
        if (since_us == 0 || (now - position).norm() > within) {
          position = now;
          since_us = state.utime;
        }
        if (state.utime - since_us >= std::chrono::microseconds(so_long).count()) return true;
      }
      std::this_thread::sleep_for(milliseconds(2));
    }
    return false;
  }
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
  /// Twists upwards for `count` ms, signed or not.
  void steer(int count, bus::MessageSigner* sealer, std::int64_t session) {
    bus::TypedPublisher<twist_command_t> publisher(*control_, "TWIST_COMMAND");
    twist_command_t message{};
    message.session = session;
    message.valid = 1;
    message.twist[2] = 0.1;
    for (int i = 0; i < count; ++i) {
      message.utime = bus::wall_clock_us();
      ++message.seq;
      if (sealer != nullptr) sealer->put(message, message.utime);
      publisher.publish(message);
      std::this_thread::sleep_for(milliseconds(1));
    }
  }
  template <class Message>
  std::vector<Message> recorded(bus::TypedSubscription<Message>& queue) {
    std::vector<Message> messages;
    Message message{};
    std::int64_t arrival_ns = 0;
    while (queue.take(message, arrival_ns)) messages.push_back(message);
    return messages;
  }

  std::string control_url_ = support::private_url(0);
  std::string housekeeping_url_ = support::private_url(1);
  std::filesystem::path folder_;
  std::string key_file_;
  std::unique_ptr<bus::MessageBus> control_, housekeeping_;
  std::unique_ptr<bus::TypedSubscription<robot_state_t>> states_;
  std::unique_ptr<bus::TypedSubscription<twist_command_t>> twists_;
  std::unique_ptr<bus::TypedSubscription<component_command_t>> commands_;
  std::unique_ptr<bus::TypedSubscription<health_t>> health_;
};

TEST_F(AccessProcess, OnlyWhoHasTheKeySteersTheDriver) {
  auto arm = std::make_unique<ChildProcess>(driver());
  Eigen::Vector3d start, now;
  ASSERT_TRUE(flange(start)) << arm->output();

  steer(300, nullptr, 11);  // a stray program
  ASSERT_TRUE(rests(now));
  EXPECT_EQ(now, start) << "moved by a program without the key";
  recorded(*twists_);

  bus::MessageSigner sealer("TWIST_COMMAND", {bus::read_key_file(key_file_), bus::wall_clock_us()});
  steer(300, &sealer, 12);
  Eigen::Vector3d moved;
  ASSERT_TRUE(rests(moved)) << "moves without commands";
  EXPECT_GT(moved.z() - start.z(), 0.01);

  // As sent by a log player: the same datagrams, in the same order, to the same arm and to the
  // next.
  const std::vector<twist_command_t> log = recorded(*twists_);
  ASSERT_GT(log.size(), 100u);
  const auto replay = [&] {
    bus::TypedPublisher<twist_command_t> publisher(*control_, "TWIST_COMMAND");
    for (const twist_command_t& message : log) {
      publisher.publish(message);
      std::this_thread::sleep_for(milliseconds(1));
    }
  };
  replay();
  ASSERT_TRUE(rests(now));
  EXPECT_EQ(now, moved) << "moved by a replayed log";

  arm->send(SIGTERM);
  ASSERT_EQ(arm->wait(milliseconds(10000)), 0);
  std::printf("%s", arm->output().c_str());
  arm = std::make_unique<ChildProcess>(driver());
  ASSERT_TRUE(flange(start));
  replay();
  ASSERT_TRUE(rests(now));
  EXPECT_EQ(now, start) << "moved by a log of the time before its start";
  arm->send(SIGTERM);
  ASSERT_EQ(arm->wait(milliseconds(10000)), 0);
  EXPECT_NE(arm->output().find("0 obeyed"), std::string::npos) << arm->output();
}

TEST_F(AccessProcess, OnlyWhoHasTheKeySteersTheSimulatedArm) {
  if (!std::filesystem::exists(kBin + "palpate-sim")) GTEST_SKIP() << "no simulator in this build";
  ChildProcess simulator({kBin + "palpate-sim", kSource + "/sim/scenes/payload.yaml", "--set",
                          "bus.control=" + control_url_, "--set",
                          "bus.housekeeping=" + housekeeping_url_, "--set",
                          "access.key_file=" + key_file_});
  constexpr double kAtRest = 1e-3;  // m: noise, and compliance of the arm
  Eigen::Vector3d start, now;
  ASSERT_TRUE(flange(start)) << simulator.output();
  steer(300, nullptr, 11);
  ASSERT_TRUE(rests(now, kAtRest));
  EXPECT_LT((now - start).norm(), kAtRest) << "moved by a program without the key";
  recorded(*twists_);

  bus::MessageSigner sealer("TWIST_COMMAND", {bus::read_key_file(key_file_), bus::wall_clock_us()});
  steer(300, &sealer, 12);
  Eigen::Vector3d moved;
  ASSERT_TRUE(rests(moved, 0.5 * kAtRest)) << "moves without commands";
  EXPECT_GT(moved.z() - start.z(), 5 * kAtRest) << simulator.output();
  bus::TypedPublisher<twist_command_t> publisher(*control_, "TWIST_COMMAND");
  for (const twist_command_t& message : recorded(*twists_)) {
    publisher.publish(message);
    std::this_thread::sleep_for(milliseconds(1));
  }
  ASSERT_TRUE(rests(now, kAtRest));
  EXPECT_LT((now - moved).norm(), kAtRest) << "moved by a replayed log";
  simulator.send(SIGTERM);
  EXPECT_EQ(simulator.wait(milliseconds(20000)), 0);
  EXPECT_NE(simulator.output().find("without access"), std::string::npos) << simulator.output();
}

TEST_F(AccessProcess, DaemonObeysWhoHasTheKeyAndNoRecordOfIt) {
  auto palpated = std::make_unique<ChildProcess>(palpated_with());
  ChildProcess arm(driver());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 100; }, health))
      << palpated->output();
  std::string said;
  EXPECT_EQ(command({"--timeout", "2", "start"}, said, false), 1) << said;
  EXPECT_NE(said.find("no_access"), std::string::npos) << said;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.commands_rejected > 0; }, health));
  EXPECT_EQ(health.state, 1) << "still inactive";
  recorded(*commands_);

  EXPECT_EQ(command({"start"}, said), 0) << said;
  EXPECT_EQ(said, "start\n");
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.state >= 2; }, health));
  EXPECT_EQ(command({"replace", "control", "--set", "provider=kinematic"}, said), 0) << said;
  EXPECT_NE(said.find("replaced"), std::string::npos) << said;
  EXPECT_EQ(command({"replace", "deformation", "--component", "no_such_model"}, said), 1) << said;
  EXPECT_NE(said.find("refused: "), std::string::npos) << said;
  EXPECT_EQ(command({"target", "no_such_feature", "1", "-2", "3"}, said), 1) << said;
  EXPECT_EQ(command({"stop"}, said), 0) << said;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.state == 1; }, health));

  const std::vector<component_command_t> log = recorded(*commands_);
  ASSERT_GE(log.size(), 4u);
  // One after the other, so that none is lost unseen.
  const auto refuses = [&](const component_command_t& message) {
    const std::int64_t before = health.commands_rejected;
    bus::TypedPublisher<component_command_t>(*control_, "COMPONENT_COMMAND").publish(message);
    return wait_health([&](const health_t& h) { return h.commands_rejected > before; }, health);
  };
  ASSERT_STREQ(bus::get_text(log.front().event), "start");
  EXPECT_TRUE(refuses(log.front())) << "replayed to the same daemon";
  EXPECT_EQ(health.state, 1);
  palpated->send(SIGTERM);
  ASSERT_EQ(palpated->wait(milliseconds(20000)), 0) << palpated->output();

  palpated = std::make_unique<ChildProcess>(palpated_with());
  ASSERT_TRUE(
      wait_health([](const health_t& h) { return h.cycles < 2000 && h.cycles > 100; }, health));
  for (const component_command_t& message : log)
    EXPECT_TRUE(refuses(message)) << "replayed to the next daemon";
  EXPECT_EQ(health.state, 1);
}

TEST_F(AccessProcess, ACommandThatWasThereBeforeTheDaemonIsObeyed) {
  ChildProcess asks({kBin + "palpate-command", "--url", control_url_, "--url",
                     "housekeeping=" + housekeeping_url_, "--key", key_file_, "--timeout", "60",
                     "start"});
  component_command_t asked{};
  std::int64_t arrival_ns = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!commands_->take(asked, arrival_ns) && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(milliseconds(5));
  ASSERT_STREQ(bus::get_text(asked.event), "start") << asks.output();
  ChildProcess palpated(palpated_with());
  ChildProcess arm(driver());
  EXPECT_EQ(asks.wait(milliseconds(70000)), 0) << asks.output() << palpated.output();
  EXPECT_EQ(asks.output(), "start\n");
  health_t health;
  EXPECT_TRUE(wait_health([](const health_t& h) { return h.state >= 2; }, health));
  EXPECT_GT(health.commands_rejected, 0) << "it was not there before the daemon";
}

/// The whole chain: command -> daemon -> driver -> daemon, each link signed.
TEST_F(AccessProcess, DaemonSteersTheDriverToATarget) {
  ChildProcess palpated(palpated_with());
  ChildProcess arm(driver());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 100; }, health))
      << palpated.output();
  Eigen::Vector3d before, now;
  ASSERT_TRUE(flange(before));
  std::string said;
  ASSERT_EQ(command({"start"}, said), 0) << said;
  ASSERT_EQ(
      command({"target", "point", "0.25", "0.03", "0.08", "--reach", "1e-9", "--timeout", "1"},
              said),
      1);
  EXPECT_NE(said.find("\nnot reached: error 0.0"), std::string::npos) << said;
  double rise = 0;
  for (int i = 0; i < 1000 && rise < 0.005; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    ASSERT_TRUE(flange(now));
    rise = now.z() - before.z();
  }
  EXPECT_GT(rise, 0.005) << palpated.output();
  EXPECT_EQ(
      command({"target", "point", "0.25", "0.03", "0.08", "--reach", "5e-3", "--timeout", "50"},
              said),
      0)
      << said;
  EXPECT_NE(said.find("\nreached: error 0.00"), std::string::npos) << said;
  arm.send(SIGTERM);
  EXPECT_EQ(arm.wait(milliseconds(10000)), 0);
  long long obeyed = 0, unauthorised = 0, rejected = 0;
  ASSERT_EQ(std::sscanf(arm.output().c_str(), "%lld obeyed, %lld unauthorised, %lld rejected",
                        &obeyed, &unauthorised, &rejected),
            3)
      << arm.output();
  // A message signed just before the driver's start may arrive just after it.
  EXPECT_LT(10 * unauthorised, obeyed) << arm.output();
  EXPECT_EQ(rejected, 0);
}

TEST_F(AccessProcess, KeysThatOthersCanReadAreRefusedByEveryProgram) {
  std::filesystem::permissions(key_file_, std::filesystem::perms::group_read,
                               std::filesystem::perm_options::add);
  ChildProcess palpated(palpated_with());
  EXPECT_EQ(palpated.wait(milliseconds(20000)), 78);
  EXPECT_NE(palpated.output().find("chmod 600"), std::string::npos) << palpated.output();
  ChildProcess arm(driver());
  EXPECT_EQ(arm.wait(milliseconds(20000)), 1);
  EXPECT_NE(arm.output().find("chmod 600"), std::string::npos) << arm.output();
  std::string said;
  EXPECT_EQ(command({"start"}, said), 1);
  EXPECT_NE(said.find("chmod 600"), std::string::npos) << said;
}

TEST_F(AccessProcess, CommandSaysWhatIsWrong) {
  std::string said;
  EXPECT_EQ(command({"--timeout", "0.5", "start"}, said), 1);
  EXPECT_NE(said.find("no answer"), std::string::npos) << said;
  EXPECT_EQ(command({}, said), 64);
  EXPECT_EQ(command({"jump"}, said), 64);
  EXPECT_EQ(command({"replace"}, said), 64);
  EXPECT_EQ(command({"--make-key", key_file_}, said), 1);
  EXPECT_NE(said.find("exists"), std::string::npos) << said;
  EXPECT_EQ(command({"--help"}, said), 0);
  EXPECT_NE(said.find("calibrate"), std::string::npos);
}

}  // namespace
}  // namespace palpate
