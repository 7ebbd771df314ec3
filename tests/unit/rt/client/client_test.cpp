#include "rt/client/client.hpp"

#include <gtest/gtest.h>

#include "rt/bus/text.hpp"

namespace palpate::client {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us

class ClientTest : public ::testing::Test {
 protected:
  ClientTest() {
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
    client_ = std::make_unique<Client>(*bus_, *bus_, access_);
  }

  Client::OnAnswer note() {
    return [this](const Answer& answer) { answers_.push_back(answer); };
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
    publish("COMPONENT_EVENT", message);
  }

  void service(std::int64_t now_us) {
    now_ = now_us;
    client_->service(now_);
  }
  template <class Message>
  void publish(const char* channel, const Message& message) {
    bus::TypedPublisher<Message>(*daemon_, channel).publish(message);
    client_->service(now_);
  }
  std::vector<shape_target_t> taken_targets() {
    std::vector<shape_target_t> all;
    shape_target_t message;
    std::int64_t arrival = 0;
    while (targets_->take(message, arrival)) all.push_back(message);
    return all;
  }

  std::int64_t now_ = kStart;
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  bus::Access access_;
  std::unique_ptr<bus::MessageBus> bus_, daemon_;
  std::unique_ptr<bus::TypedSubscription<component_command_t>> commands_;
  std::unique_ptr<bus::TypedSubscription<shape_target_t>> targets_;
  std::unique_ptr<bus::TypedSubscription<manual_force_t>> forces_;
  std::unique_ptr<Client> client_;
  std::vector<Answer> answers_;
};

TEST_F(ClientTest, RepeatsTheSameUntilItIsAnswered) {
  client_->ask(make_command({"start"}), kStart, note());
  for (int i = 1; i <= 10; ++i) service(kStart + i * 100'000);
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
  service(kStart + 9'000'000);
  EXPECT_TRUE(taken().empty());
}

TEST_F(ClientTest, AReplacementHasTwoAnswersAndOthersPassItBy) {
  client_->ask(make_command({"replace", "deformation", "", "linear"}), kStart, note());
  const std::int64_t replace = taken()[0].counter;
  say("deformation", "replacing", replace);
  say("deformation", "replacing", replace);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_FALSE(answers_[0].last);
  client_->ask(make_command({"stop"}), kStart + 1, note());
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
  EXPECT_EQ(client_->pending(), 0U);
}

TEST_F(ClientTest, WhatWasSealedBeforeTheDaemonsStartIsSealedAgain) {
  client_->ask(make_command({"start"}), kStart, note());
  const component_command_t early = taken()[0];
  say("all", "no_access", -1, "1 of COMPONENT_COMMAND, the last one: no valid authentication code");
  service(kStart + 300'000);
  EXPECT_EQ(taken()[0].counter, early.counter) << "another one's, perhaps";
  say("all", "no_access", early.counter);
  EXPECT_TRUE(answers_.empty());
  service(kStart + 600'000);
  const component_command_t late = taken()[0];
  EXPECT_GT(late.counter, early.counter);
  EXPECT_STREQ(bus::get_text(late.event), "start");
  say("all", "start", late.counter);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].event, "start");
}

TEST_F(ClientTest, GivesUp) {
  client_->ask(make_command({"zero"}), kStart, note());
  service(kStart + 4'900'000);
  EXPECT_TRUE(answers_.empty());
  service(kStart + 5'000'000);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(answers_[0].event, "");
  EXPECT_NE(answers_[0].reason.find("no answer"), std::string::npos);
}

TEST_F(ClientTest, ATargetComesInNewRevisionsAndTheLastOneCounts) {
  client_->ask(make_target("point", {}, {1, 2, 3}), kStart, note());
  service(kStart + 200'000);
  client_->ask(make_target("point", {}, {4, 5, 6}), kStart + 300'000, note());
  ASSERT_EQ(answers_.size(), 1U) << "the first is given up";
  const auto sent = taken_targets();
  ASSERT_EQ(sent.size(), 3U);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(sent[static_cast<std::size_t>(i)].revision, i + 1);
  EXPECT_EQ(sent[2].values[0], 4);
  say("feature", "target", sent[2].counter);
  ASSERT_EQ(answers_.size(), 2U);
  EXPECT_EQ(answers_[1].event, "target");
}

TEST_F(ClientTest, SealsWithTheKey) {
  access_.key.emplace();
  access_.key->fill(9);
  Client sealed(*bus_, *bus_, access_);
  sealed.apply_force({0.1, 0.2, 0.3}, {1, 2, 3}, kStart);
  manual_force_t force;
  std::int64_t arrival = 0;
  ASSERT_TRUE(forces_->take(force, arrival));
  EXPECT_TRUE(bus::verify(*access_.key, "MANUAL_FORCE", force));
  EXPECT_EQ(force.rest_point[1], 0.2);
  EXPECT_EQ(force.force[2], 3);
  sealed.ask(make_command({"start"}), kStart, note());
  EXPECT_TRUE(bus::verify(*access_.key, "COMPONENT_COMMAND", taken().at(0)));
}

TEST_F(ClientTest, ATargetThatIsSetIsRepeatedAsOneRevision) {
  client_->set_target(make_target("point", {}, {1, 2, 3}), kStart);
  for (int i = 1; i <= 20; ++i) service(kStart + i * 100'000);
  auto sent = taken_targets();
  ASSERT_EQ(sent.size(), 5U) << "at 2 Hz";
  for (const shape_target_t& message : sent) EXPECT_EQ(message.revision, sent[0].revision);
  EXPECT_GT(sent[1].counter, sent[0].counter);
  client_->set_target(make_target("point", {}, {4, 5, 6}), now_);
  client_->repeat_target(now_);
  sent = taken_targets();
  ASSERT_EQ(sent.size(), 2U);
  EXPECT_EQ(sent[0].revision, client_->target_revision());
  EXPECT_EQ(sent[1].revision, client_->target_revision());
  EXPECT_EQ(sent[1].values[2], 6);
}

TEST_F(ClientTest, AForceIsRenewedUntilItsEnd) {
  client_->apply_force({0, 0, 0}, {0, 0, 1}, kStart, kStart + 200'000);
  for (int i = 1; i <= 30; ++i) service(kStart + i * 20'000);
  manual_force_t force;
  std::int64_t arrival = 0;
  int count = 0;
  for (; forces_->take(force, arrival); ++count) EXPECT_EQ(force.force[2], 1);
  EXPECT_EQ(count, 4) << "at 0, 60, 120 and 180 ms: each is valid for 100 ms";
  client_->apply_force({0, 0, 0}, {0, 0, 2}, now_);
  service(now_ + 60'000);
  EXPECT_TRUE(forces_->take(force, arrival));
  EXPECT_FALSE(forces_->take(force, arrival));
}

TEST_F(ClientTest, SendsOnceAndReportsWhatTheDaemonPublishes) {
  client_->send({"start"}, kStart);
  service(kStart + 1'000'000);
  EXPECT_EQ(taken().size(), 1U);
  EXPECT_FALSE(client_->is_running());
  EXPECT_FALSE(client_->target_error());
  health_t health{};
  health.state = health_t::STATE_DEGRADED;
  health.input_count = 2;
  bus::put_text(health.input_name[1], "ROBOT_STATE");
  health.received[1] = 7;
  publish("HEALTH", health);
  EXPECT_TRUE(client_->is_running());
  EXPECT_FALSE(client_->is_active());
  EXPECT_EQ(client_->received("ROBOT_STATE"), 7);
  EXPECT_EQ(client_->received("IMU"), 0);

  client_->set_target(make_target("point", {}, {1, 2, 3}), now_);
  feature_t feature{};
  feature.revision = client_->target_revision() - 1;
  feature.error_count = 2;
  feature.error[0] = 3, feature.error[1] = -4;
  publish("FEATURE", feature);
  EXPECT_FALSE(client_->target_error()) << "of another target";
  ++feature.revision;
  publish("FEATURE", feature);
  EXPECT_EQ(client_->target_error(), 5);

  say("feature", "refused", -1, "no such feature");
  EXPECT_EQ(client_->refusal(), "no such feature");
}

TEST_F(ClientTest, WaitsForAConditionAndForAnAnswer) {
  int looks = 0;
  EXPECT_TRUE(client_->wait(10, [&] { return ++looks == 3; }));
  EXPECT_FALSE(client_->wait(0.01, [] { return false; }));
  const Answer answer = client_->ask_and_wait(make_command({"start"}), 0.05);
  EXPECT_EQ(answer.event, "");
  EXPECT_FALSE(answer.done());
  EXPECT_EQ(client_->pending(), 0U);
}

}  // namespace
}  // namespace palpate::client
