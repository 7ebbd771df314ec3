#include "tools/view/commander.hpp"

#include <gtest/gtest.h>

#include "rt/bus/text.hpp"
#include "tools/command/request.hpp"

namespace palpate::view {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us

class CommanderTest : public ::testing::Test {
 protected:
  CommanderTest() {
    access_.start_us = kStart;
    bus_ = bus::make_memory_bus(hub_);
    daemon_ = bus::make_memory_bus(hub_);
    commands_ = std::make_unique<bus::TypedSubscription<component_command_t>>(
        *daemon_, "COMPONENT_COMMAND", 64);
    targets_ =
        std::make_unique<bus::TypedSubscription<shape_target_t>>(*daemon_, "SHAPE_TARGET", 64);
    forces_ =
        std::make_unique<bus::TypedSubscription<manual_force_t>>(*daemon_, "MANUAL_FORCE", 64);
    daemon_->start();
    bus_->start();
    commander_ = std::make_unique<Commander>(*bus_, access_);
  }

  Commander::Heard note() {
    return [this](const Commander::Answer& answer) { answers_.push_back(answer); };
  }
  std::vector<component_command_t> taken() {
    std::vector<component_command_t> all;
    component_command_t message;
    std::int64_t arrival = 0;
    while (commands_->take(message, arrival)) all.push_back(message);
    return all;
  }
  void say(const char* slot, const char* event, std::int64_t counter, const char* reason = "") {
    component_event_t message{};
    bus::put_text(message.slot, slot);
    bus::put_text(message.event, event);
    bus::put_text(message.reason, reason);
    message.command_counter = counter;
    commander_->hear(message);
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  bus::Access access_;
  std::unique_ptr<bus::MessageBus> bus_, daemon_;
  std::unique_ptr<bus::TypedSubscription<component_command_t>> commands_;
  std::unique_ptr<bus::TypedSubscription<shape_target_t>> targets_;
  std::unique_ptr<bus::TypedSubscription<manual_force_t>> forces_;
  std::unique_ptr<Commander> commander_;
  std::vector<Commander::Answer> answers_;
};

TEST_F(CommanderTest, RepeatsTheSameUntilItIsAnswered) {
  commander_->ask(command::make_command({"start", "all", "", "", ""}), kStart, note());
  for (int i = 1; i <= 10; ++i) commander_->service(kStart + i * 100'000);
  const auto sent = taken();
  ASSERT_EQ(sent.size(), 6U) << "every 0.2 s";
  for (const auto& message : sent) {
    EXPECT_EQ(message.counter, sent[0].counter);
    EXPECT_EQ(message.session, sent[0].session);
  }
  say("all", "active", -1);
  say("all", "stop", sent[0].counter + 5);
  EXPECT_TRUE(answers_.empty()) << "answers to another sender";
  say("all", "start", sent[0].counter);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].event, "start");
  EXPECT_TRUE(answers_[0].last);
  commander_->service(kStart + 9'000'000);
  EXPECT_TRUE(taken().empty());
}

TEST_F(CommanderTest, AReplacementHasTwoAnswersAndOthersPassItBy) {
  commander_->ask(command::make_command({"replace", "deformation", "", "linear", ""}), kStart,
                  note());
  const std::int64_t replace = taken()[0].counter;
  say("deformation", "replacing", replace);
  say("deformation", "replacing", replace);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_FALSE(answers_[0].last);
  commander_->ask(command::make_command({"stop", "all", "", "", ""}), kStart + 1, note());
  const std::int64_t stop = taken()[0].counter;
  EXPECT_GT(stop, replace);
  say("all", "stop", stop);
  ASSERT_EQ(answers_.size(), 2U);
  EXPECT_EQ(answers_[1].event, "stop");
  say("deformation", "repeated", replace, "was carried out before");
  EXPECT_EQ(answers_.size(), 2U);
  say("deformation", "replaced", replace);
  ASSERT_EQ(answers_.size(), 3U);
  EXPECT_EQ(answers_[2].event, "replaced");
  EXPECT_EQ(commander_->under_way(), 0U);
}

TEST_F(CommanderTest, WhatWasSealedBeforeTheDaemonsStartIsSealedAgain) {
  commander_->ask(command::make_command({"start", "all", "", "", ""}), kStart, note());
  const component_command_t early = taken()[0];
  say("all", "no_access", -1, "1 of COMPONENT_COMMAND, the last one: no valid authentication code");
  commander_->service(kStart + 300'000);
  EXPECT_EQ(taken()[0].counter, early.counter) << "another one's, perhaps";
  say("all", "no_access", early.counter);
  EXPECT_TRUE(answers_.empty());
  commander_->service(kStart + 600'000);
  const component_command_t late = taken()[0];
  EXPECT_GT(late.counter, early.counter);
  EXPECT_STREQ(bus::get_text(late.event), "start");
  say("all", "start", late.counter);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].event, "start");
}

TEST_F(CommanderTest, GivesUp) {
  commander_->ask(command::make_command({"zero", "all", "", "", ""}), kStart, note());
  commander_->service(kStart + 4'900'000);
  EXPECT_TRUE(answers_.empty());
  commander_->service(kStart + 5'000'000);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].event, "");
  EXPECT_NE(answers_[0].reason.find("no answer"), std::string::npos);
}

TEST_F(CommanderTest, ATargetComesInNewRevisionsAndTheLastOneCounts) {
  commander_->ask(command::make_target("point", {}, {1, 2, 3}), kStart, note());
  commander_->service(kStart + 200'000);
  commander_->ask(command::make_target("point", {}, {4, 5, 6}), kStart + 300'000, note());
  ASSERT_EQ(answers_.size(), 1U) << "the first is given up";
  shape_target_t message;
  std::int64_t arrival = 0;
  std::vector<int> revisions;
  while (targets_->take(message, arrival)) revisions.push_back(message.revision);
  EXPECT_EQ(revisions, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(message.values[0], 4);
  say("feature", "target", message.counter);
  ASSERT_EQ(answers_.size(), 2U);
  EXPECT_EQ(answers_[1].event, "target");
}

TEST_F(CommanderTest, SealsWithTheKey) {
  access_.key.emplace();
  access_.key->fill(9);
  Commander sealed(*bus_, access_);
  sealed.push({0.1, 0.2, 0.3}, {1, 2, 3}, kStart);
  manual_force_t force;
  std::int64_t arrival = 0;
  ASSERT_TRUE(forces_->take(force, arrival));
  EXPECT_TRUE(bus::verify(*access_.key, "MANUAL_FORCE", force));
  EXPECT_EQ(force.rest_point[1], 0.2);
  EXPECT_EQ(force.force[2], 3);
  sealed.ask(command::make_command({"start", "all", "", "", ""}), kStart, note());
  EXPECT_TRUE(bus::verify(*access_.key, "COMPONENT_COMMAND", taken().at(0)));
}

}  // namespace
}  // namespace palpate::view
