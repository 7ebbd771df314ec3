// Messages that a daemon with a key accepts, and its reports of the others.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <palpate/manual_force_t.hpp>

#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"

namespace palpate::daemon {
namespace {

class DaemonAccess : public ::testing::Test {
 protected:
  DaemonAccess() {
    bus_->start();
    bus::record(*hub_, &published_);
  }
  ~DaemonAccess() override {
    bus::record(*hub_, nullptr);
    std::filesystem::remove(key_file_);
  }

  static component_command_t event(const char* name) {
    component_command_t message{};
    message.session = 42;
    bus::put_text(message.slot, "all");
    bus::put_text(message.event, name);
    return message;
  }
  component_command_t sealed(const char* name) {
    component_command_t message = event(name);
    sealer_.put(message, 0);
    return message;
  }
  template <class Message>
  void send(const char* channel, const Message& message) {
    bus::TypedPublisher<Message>(*sender_, channel).publish(message);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      now_ns_ += 1'000'000;
      daemon_->tick({now_ns_, now_ns_ / 1000, 0});
    }
  }
  template <class Message>
  std::vector<Message> sent(const std::string& channel) const {
    std::vector<Message> found;
    for (const bus::Published& p : published_) {
      if (p.channel != channel) continue;
      found.emplace_back();
      found.back().decode(p.data.data(), 0, static_cast<int>(p.data.size()));
    }
    return found;
  }
  std::vector<std::string> reasons_of(const std::string& name) const {
    std::vector<std::string> reasons;
    for (const component_event_t& e : sent<component_event_t>("COMPONENT_EVENT"))
      if (bus::get_text(e.event) == name) reasons.push_back(bus::get_text(e.reason));
    return reasons;
  }
  bool runs() { return daemon_->pipeline().is_running(); }

  static std::filesystem::path new_key_file() {
    const auto path = std::filesystem::temp_directory_path() /
                      ("palpate_daemon_access_" + std::to_string(getpid()));
    std::filesystem::remove(path);
    bus::make_key_file(path);
    return path;
  }

  std::filesystem::path key_file_ = new_key_file();
  bus::Access access_{bus::read_key_file(key_file_), 0};
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> sender_ = bus::make_memory_bus(hub_);
  bus::MessageSigner sealer_{"COMPONENT_COMMAND", access_};
  std::unique_ptr<Daemon> daemon_ = std::make_unique<Daemon>(
      config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml",
                              {"access.key_file=" + key_file_.string()}),
      *bus_, *bus_, Mode::kDeterministic, 1);
  std::vector<bus::Published> published_;
  std::int64_t now_ns_ = 0;
};

TEST_F(DaemonAccess, ObeysWhoKnowsTheKey) {
  send("COMPONENT_COMMAND", sealed("start"));
  run(3);
  EXPECT_TRUE(runs());
  send("COMPONENT_COMMAND", sealed("stop"));
  run(3);
  EXPECT_FALSE(runs());
  EXPECT_TRUE(reasons_of("no_access").empty());
}

TEST_F(DaemonAccess, RefusesForgedChangedAndMisdirectedCommands) {
  component_command_t forged = event("start");
  forged.counter = 1;
  send("COMPONENT_COMMAND", forged);
  component_command_t changed = sealed("stop");
  bus::put_text(changed.event, "start");
  send("COMPONENT_COMMAND", changed);
  component_command_t foreign = event("start");
  bus::Key other = *access_.key;
  other[0] ^= 1;
  bus::MessageSigner("COMPONENT_COMMAND", {other, 0}).put(foreign, 0);
  send("COMPONENT_COMMAND", foreign);
  component_command_t misdirected = event("start");
  bus::MessageSigner("SHAPE_TARGET", access_).put(misdirected, 0);
  send("COMPONENT_COMMAND", misdirected);
  run(200);
  EXPECT_FALSE(runs());
  EXPECT_EQ(sent<health_t>("HEALTH").back().commands_rejected, 4);
}

TEST_F(DaemonAccess, RefusesARecordedStart) {
  const component_command_t start = sealed("start");
  send("COMPONENT_COMMAND", start);
  run(3);
  send("COMPONENT_COMMAND", sealed("stop"));
  run(3);
  send("COMPONENT_COMMAND", start);
  run(200);
  EXPECT_FALSE(runs());
  EXPECT_EQ(sent<health_t>("HEALTH").back().commands_rejected, 1);
}

TEST_F(DaemonAccess, AnswersACommandThatComesAgainAsBefore) {
  const component_command_t unknown = sealed("jump");
  for (int i = 0; i < 3; ++i) send("COMPONENT_COMMAND", unknown);
  run(3);
  const std::vector<std::string> refused = reasons_of("refused");
  ASSERT_EQ(refused.size(), 3u);
  EXPECT_NE(refused[0].find("unknown event"), std::string::npos);
  EXPECT_EQ(refused[2], refused[0]);
  EXPECT_TRUE(reasons_of("no_access").empty());
}

TEST_F(DaemonAccess, ReportsAFloodOnceASecondAndCountsAll) {
  for (int i = 0; i < 2500; ++i) {
    send("COMPONENT_COMMAND", event("start"));
    run(1);
  }
  run(100);
  EXPECT_FALSE(runs());
  EXPECT_EQ(sent<health_t>("HEALTH").back().commands_rejected, 2500);
  const std::vector<std::string> reasons = reasons_of("no_access");
  ASSERT_GE(reasons.size(), 2u);
  EXPECT_LE(reasons.size(), 3u);
  EXPECT_NE(reasons.back().find("COMPONENT_COMMAND"), std::string::npos);
  EXPECT_NE(reasons.back().find("no valid authentication code"), std::string::npos);
}

TEST_F(DaemonAccess, TargetsAndManualForcesNeedACodeAsWell) {
  shape_target_t target{};
  target.session = 42;
  target.revision = 1;
  target.chunks = 1;
  bus::put_text(target.kind, "point");
  target.value_count = 3;
  manual_force_t force{};
  force.session = 42;
  force.seq = 1;
  send("SHAPE_TARGET", target);
  send("MANUAL_FORCE", force);
  run(200);
  EXPECT_EQ(sent<health_t>("HEALTH").back().commands_rejected, 2);
  EXPECT_EQ(daemon_->inputs().signals().manual.freshness, Freshness::kNoData);
  EXPECT_TRUE(reasons_of("target").empty());

  bus::MessageSigner("SHAPE_TARGET", access_).put(target, 0);
  bus::MessageSigner("MANUAL_FORCE", access_).put(force, 0);
  send("SHAPE_TARGET", target);
  send("MANUAL_FORCE", force);
  run(3);
  EXPECT_EQ(reasons_of("target").size(), 1u);
  EXPECT_NE(daemon_->inputs().signals().manual.freshness, Freshness::kNoData);
}

TEST_F(DaemonAccess, ItsOwnCommandsAreSealedAndCountFromOne) {
  run(5);
  bus::ReplayGuard robot("TWIST_COMMAND", access_);
  const std::vector<twist_command_t> commands = sent<twist_command_t>("TWIST_COMMAND");
  ASSERT_EQ(commands.size(), 5u);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    EXPECT_EQ(commands[i].counter, static_cast<std::int64_t>(i) + 1);
    EXPECT_EQ(robot.judge(commands[i]), bus::Admitted::kFresh);
  }
}

TEST_F(DaemonAccess, InRealTimeCountersAreThoseOfTheWallClock) {
  const auto root =
      config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml",
                              {"access.key_file=" + key_file_.string()});
  const std::int64_t before = bus::wall_clock_us();
  send("COMPONENT_COMMAND", sealed("stop"));  // no subscriber yet
  Daemon daemon(root, *bus_, *bus_, Mode::kRealTime, 1);
  send("COMPONENT_COMMAND", sealed("start"));  // its counter is 2: outdated
  published_.clear();
  for (int i = 1; i <= 3; ++i) daemon.tick({1'000'000 * i, bus::wall_clock_us(), 0});
  EXPECT_FALSE(daemon.pipeline().is_running());
  // So that its sender can sign it again.
  const auto events = sent<component_event_t>("COMPONENT_EVENT");
  const auto refused = std::find_if(events.begin(), events.end(), [](const component_event_t& e) {
    return std::string(bus::get_text(e.event)) == "no_access";
  });
  ASSERT_NE(refused, events.end());
  EXPECT_EQ(refused->command_counter, 2);
  for (const twist_command_t& command : sent<twist_command_t>("TWIST_COMMAND"))
    EXPECT_GE(command.counter, before);
  component_command_t start = event("start");
  bus::MessageSigner("COMPONENT_COMMAND", {access_.key, 1}).put(start, bus::wall_clock_us() + 1);
  send("COMPONENT_COMMAND", start);
  daemon.tick({4'000'000, bus::wall_clock_us(), 0});
  EXPECT_TRUE(daemon.pipeline().is_running());
}

TEST(DaemonAccessKey, FaultsInItsFileAreConfigurationErrors) {
  const auto complaint = [](const std::string& section) -> std::string {
    try {
      read_settings(config::Node::from_text(section));
    } catch (const config::Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint("access: {key_file: nowhere.key}").find("access.key_file"),
            std::string::npos);
  EXPECT_NE(complaint("access: {key_file: nowhere.key}").find("nowhere.key"), std::string::npos);
  EXPECT_NE(complaint("access: {}").find("key_file"), std::string::npos);
  EXPECT_EQ(complaint("loop: {}"), "");
}

}  // namespace
}  // namespace palpate::daemon
