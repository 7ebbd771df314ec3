#include "sim/scenes/command_receiver.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "tests/unit/sim/scenes/stage.hpp"

namespace palpate::scenes {
namespace {

/// An arm of a scene with a key.
class CommandAccess : public ::testing::Test {
 protected:
  ~CommandAccess() override { std::filesystem::remove(key_file_); }

  static std::filesystem::path new_key_file() {
    const auto path = std::filesystem::temp_directory_path() /
                      ("palpate_command_access_" + std::to_string(getpid()));
    std::filesystem::remove(path);
    bus::make_key_file(path);
    return path;
  }
  template <class Message>
  Message moving() {
    Message message{};
    message.session = 5;
    message.seq = ++seq_;
    message.valid = 1;
    return message;
  }
  twist_command_t up() {
    auto message = moving<twist_command_t>();
    message.twist[2] = 0.05;
    return message;
  }
  template <class Message>
  void send(const char* channel, const Message& message) {
    bus::TypedPublisher<Message>(*stage_.daemon, channel).publish(message);
  }
  double speed() const { return stage_.simulation.robot().flange_twist().linear.norm(); }
  const CommandReceiver& receiver() const { return stage_.simulation.commands(); }

  std::filesystem::path key_file_ = new_key_file();
  bus::Access access_{bus::read_key_file(key_file_), 0};
  Stage stage_{kControl, coarse({"access.key_file=" + key_file_.string()})};
  std::int32_t seq_ = 0;
};

TEST_F(CommandAccess, WhoHasNotTheKeyMovesNothing) {
  for (int i = 0; i < 50; ++i) {
    send("TWIST_COMMAND", up());
    auto joints = moving<joint_velocity_command_t>();
    joints.joint_count = 7;
    joints.dq[6] = 0.2;
    send("JOINT_VELOCITY_COMMAND", joints);
    stage_.simulation.step();
  }
  hand_command_t hand{};
  hand.session = 5;
  hand.seq = 1;
  send("HAND_COMMAND", hand);
  stage_.run(0.02);
  EXPECT_EQ(receiver().accepted(), 0);
  EXPECT_EQ(receiver().rejected(), 101);
  EXPECT_EQ(receiver().unauthorised(), 101);
  EXPECT_LT(speed(), 1e-4);
  EXPECT_EQ(stage_.simulation.robot().hand_positions().norm(), 0);
}

TEST_F(CommandAccess, WhoHasItSteersAndCannotBeReplayed) {
  bus::MessageSigner sealer("TWIST_COMMAND", access_);
  std::vector<twist_command_t> recorded;
  for (int i = 0; i < 200; ++i) {
    recorded.push_back(up());
    sealer.put(recorded.back(), 0);
    send("TWIST_COMMAND", recorded.back());
    stage_.simulation.step();
  }
  EXPECT_EQ(receiver().accepted(), 200);
  EXPECT_NEAR(speed(), 0.05, 2e-3);
  stage_.run(0.3);
  ASSERT_LT(speed(), 1e-3);
  for (twist_command_t message : recorded) {
    send("TWIST_COMMAND", message);
    message.session = 6;  // as recent as a forger can make it
    send("TWIST_COMMAND", message);
    stage_.simulation.step();
    EXPECT_LT(speed(), 1e-3);
  }
  EXPECT_EQ(receiver().accepted(), 200);
  EXPECT_EQ(receiver().unauthorised(), 399)
      << "the very last one is known, and rejected all the same";
  EXPECT_EQ(receiver().rejected(), 400);
}

TEST_F(CommandAccess, ForgedMessagesLeaveTheOrderAlone) {
  bus::MessageSigner sealer("TWIST_COMMAND", access_);
  for (int i = 0; i < 100; ++i) {
    twist_command_t stray = up();
    stray.session = 77;
    send("TWIST_COMMAND", stray);
    twist_command_t good = up();
    sealer.put(good, 0);
    send("TWIST_COMMAND", good);
    stage_.simulation.step();
  }
  EXPECT_EQ(receiver().accepted(), 100);
}

TEST_F(CommandAccess, WhatWasSentBeforeTheStartIsRefused) {
  stage_.simulation.start_clock(1'000'000);
  bus::MessageSigner sealer("TWIST_COMMAND", {access_.key, 1});
  for (const std::int64_t sent_at : {999'000, 1'000'001}) {
    twist_command_t message = up();
    sealer.put(message, sent_at);
    send("TWIST_COMMAND", message);
    stage_.simulation.step();
  }
  EXPECT_EQ(receiver().unauthorised(), 1);
  EXPECT_EQ(receiver().accepted(), 1);
}

}  // namespace
}  // namespace palpate::scenes
