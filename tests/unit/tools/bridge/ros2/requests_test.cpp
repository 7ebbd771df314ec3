#include "tools/bridge/ros2/requests.hpp"

#include <gtest/gtest.h>

#include "rt/bus/stamped_publisher.hpp"
#include "rt/bus/text.hpp"
#include "tests/unit/tools/bridge/ros2/cell.hpp"

namespace palpate::ros2_bridge {
namespace {

/// A stand-in for palpated that answers each command.
class Requests : public testing::Test {
 protected:
  void answer(const char* event, const char* reason) {
    std::int64_t arrival_ns = 0;
    while (commands_.take(command, arrival_ns)) {
      component_event_t answer{};
      bus::put_text(answer.slot, "all");
      bus::put_text(answer.event, event);
      bus::put_text(answer.reason, reason);
      answer.command_counter = command.counter;
      events_.publish(answer, 1);
    }
  }
  bool take_target() {
    std::int64_t arrival_ns = 0;
    return targets_.take(target, arrival_ns);
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(hub_),
                                   peer_ = bus::make_memory_bus(hub_);
  client::Client client{*bus_, *bus_, {}, 1};
  component_command_t command{};
  shape_target_t target{};

 private:
  bus::TypedSubscription<component_command_t> commands_{*peer_, "COMPONENT_COMMAND", 8};
  bus::TypedSubscription<shape_target_t> targets_{*peer_, "SHAPE_TARGET", 8};
  bus::StampedPublisher<component_event_t> events_{*peer_, "COMPONENT_EVENT", 7};
};

TEST_F(Requests, AServiceAnswersItsClientWhenPalpatedHas) {
  TriggerService service(ours(), "cell/zero", "zero", client);
  Participant::Endpoint endpoint{"cell/zero", Quality::kReliable, 10};
  endpoint.prefix = "rq/";
  endpoint.suffix = "Request";
  Writer<TriggerRequest> requests(theirs(), endpoint);
  endpoint.prefix = "rr/";
  endpoint.suffix = "Reply";
  Reader<TriggerResponse> replies(theirs(), endpoint);

  requests.write({0x123456789abcdef0, 41, 0});
  service.cycle(1000);
  EXPECT_EQ(replies.next(), nullptr) << "palpated has not answered";
  answer("zero", "tared");
  EXPECT_STREQ(bus::get_text(command.event), "zero");
  client.service(2000);
  service.cycle(2000);
  const TriggerResponse* reply = replies.next();
  ASSERT_NE(reply, nullptr);
  EXPECT_EQ(reply->client, 0x123456789abcdef0u);
  EXPECT_EQ(reply->sequence_number, 41);
  EXPECT_TRUE(reply->success);
  EXPECT_STREQ(reply->message, "zero: tared");

  requests.write({5, 42, 0});
  service.cycle(3000);
  answer("refused", "something is held");
  client.service(4000);
  service.cycle(4000);
  reply = replies.next();
  ASSERT_NE(reply, nullptr);
  EXPECT_EQ(reply->sequence_number, 42);
  EXPECT_FALSE(reply->success);

  requests.write({5, 43, 0});
  service.cycle(5000);
  client.service(6'000'000);  // without an answer
  service.cycle(6'000'000);
  reply = replies.next();
  ASSERT_NE(reply, nullptr);
  EXPECT_FALSE(reply->success);
  EXPECT_NE(std::string(reply->message).find("no answer"), std::string::npos);
}

TEST_F(Requests, AFloodIsRefused) {
  TriggerService service(ours(), "cell/stop", "stop", client);
  Participant::Endpoint endpoint{"cell/stop", Quality::kReliable, 10};
  endpoint.prefix = "rq/";
  endpoint.suffix = "Request";
  Writer<TriggerRequest> requests(theirs(), endpoint);
  for (std::int64_t i = 0; i < 100; ++i) {
    requests.write({1, i, 0});
    service.cycle(1000);
  }
  EXPECT_EQ(client.pending(), 32u);
}

TEST_F(Requests, WordsAreCommandsAndOthersAreRefused) {
  CommandTopic topic(ours(), "command", client);
  Writer<String> commands(theirs(), {"command", Quality::kReliable, 4});
  std::string word = "replace";
  commands.write({word.data()});
  topic.cycle(1000);
  EXPECT_EQ(client.pending(), 0u);
  EXPECT_EQ(topic.intake().counts().malformed, 1);
  word = "stop";
  commands.write({word.data()});
  topic.cycle(2000);
  answer("stop", "");
  EXPECT_STREQ(bus::get_text(command.event), "stop");
  client.service(3000);
  EXPECT_EQ(client.pending(), 0u);
}

TEST_F(Requests, TargetsAreTransformedToTheObject) {
  TargetTopic::Options options;
  options.topic = "target";
  options.kind = "pose";
  options.X_WO.translation() = Eigen::Vector3d(1, 0, 0);
  options.X_WO.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  TargetTopic topic(ours(), options, client);
  Writer<PoseStamped> targets(theirs(), {"target", Quality::kReliable});
  std::string frame = "base_link";
  PoseStamped message{};
  message.header = {{0, 0}, frame.data()};
  message.pose = {{1.5, 0.25, 0}, {0, 0, 0, 1}};
  targets.write(message);
  topic.cycle(1000);
  ASSERT_TRUE(take_target());
  EXPECT_STREQ(bus::get_text(target.kind), "pose");
  ASSERT_EQ(target.value_count, 7);
  EXPECT_NEAR(target.values[0], -0.5, 1e-12);
  EXPECT_NEAR(target.values[1], -0.25, 1e-12);
  EXPECT_NEAR(std::abs(target.values[6]), 1, 1e-12) << "half a turn about z";

  frame = "camera";
  targets.write(message);
  topic.cycle(2000);
  frame = "object";
  message.pose.orientation = {0, 0, 0, 0};
  targets.write(message);
  topic.cycle(3000);
  EXPECT_EQ(topic.intake().counts().malformed, 2);
  EXPECT_FALSE(take_target());
}

TEST_F(Requests, TargetsOfAPointHaveThreeValues) {
  TargetTopic::Options options;
  options.topic = "point_target";
  options.rest_points = {0.1, 0.2, 0.3};
  TargetTopic topic(ours(), options, client);
  Writer<PointStamped> targets(theirs(), {"point_target", Quality::kReliable});
  std::string frame = "object";
  targets.write({{{0, 0}, frame.data()}, {0.4, 0.5, 0.6}});
  topic.cycle(1000);
  ASSERT_TRUE(take_target());
  ASSERT_EQ(target.value_count, 3);
  EXPECT_EQ(target.values[2], 0.6);
  ASSERT_EQ(target.point_count, 1);
  EXPECT_EQ(target.rest_points[0][1], 0.2);
}

}  // namespace
}  // namespace palpate::ros2_bridge
