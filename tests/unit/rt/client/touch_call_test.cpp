#include "rt/client/touch_call.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace palpate::client {
namespace {

constexpr std::int64_t kTouchStart = 1'700'000'000'000'000;  // us

class TouchCallTest : public ::testing::Test {
 protected:
  TouchCallTest()
      : bus_(bus::make_memory_bus(hub_)),
        daemon_(bus::make_memory_bus(hub_)),
        requests_(*daemon_, "TOUCH_REQUEST", 64),
        call_(*bus_, {{}, kTouchStart}, 7) {
    daemon_->start();
    bus_->start();
    wanted_.force = 0.2;
    wanted_.direction[2] = -1;
  }

  std::vector<touch_request_t> taken() {
    std::vector<touch_request_t> all;
    touch_request_t message;
    std::int64_t arrival = 0;
    while (requests_.take(message, arrival)) all.push_back(message);
    return all;
  }
  void say(std::int32_t request, std::int32_t state) {
    touch_t message{};
    message.request = request;
    message.state = state;
    bus::TypedPublisher<touch_t>(*daemon_, "TOUCH").publish(message);
  }
  void service(double seconds) {
    call_.service(kTouchStart + static_cast<std::int64_t>(1e6 * seconds));
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_, daemon_;
  bus::TypedSubscription<touch_request_t> requests_;
  TouchCall call_;
  touch_request_t wanted_{};
};

TEST_F(TouchCallTest, RepeatsTheRequestUntilItIsHeard) {
  call_.begin(wanted_, kTouchStart);
  for (int i = 1; i <= 10; ++i) service(0.1 * i);
  const auto sent = taken();
  ASSERT_EQ(sent.size(), 6U) << "every 0.2 s";
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].request, sent[0].request);
    EXPECT_GT(sent[i].request, 0);
    EXPECT_EQ(sent[i].action, touch_request_t::START);
    EXPECT_EQ(sent[i].force, 0.2);
    EXPECT_EQ(sent[i].session, 7);
    if (i > 0) {
      EXPECT_GT(sent[i].counter, sent[i - 1].counter) << "its own counter";
    }
  }
  EXPECT_EQ(call_.silence(kTouchStart + 500'000), 500'000);
  say(sent[0].request, touch_t::WAITING);
  service(1.05);
  ASSERT_TRUE(call_.latest());
  for (int i = 11; i <= 20; ++i) service(0.1 * i);
  EXPECT_TRUE(taken().empty());
  EXPECT_FALSE(call_.has_ended());
}

TEST_F(TouchCallTest, FollowsItsOwnMotionOnly) {
  call_.begin(wanted_, kTouchStart);
  const std::int32_t own = taken().at(0).request;
  say(own + 1, touch_t::TOUCHED);
  service(0.01);
  EXPECT_FALSE(call_.latest());
  say(own, touch_t::APPROACHING);
  say(own, touch_t::TOUCHED);
  service(0.02);
  EXPECT_TRUE(call_.has_ended());
  EXPECT_STREQ(name_of_state(*call_.latest()), "touched");
}

TEST_F(TouchCallTest, CancelsUntilTheMotionHasEnded) {
  call_.begin(wanted_, kTouchStart);
  const std::int32_t own = taken().at(0).request;
  say(own, touch_t::APPROACHING);
  service(0.01);
  call_.cancel(kTouchStart + 20'000);
  for (int i = 1; i <= 5; ++i) service(0.02 + 0.1 * i);
  const auto sent = taken();
  ASSERT_EQ(sent.size(), 3U);
  for (const touch_request_t& message : sent) {
    EXPECT_EQ(message.action, touch_request_t::CANCEL);
    EXPECT_EQ(message.request, own);
  }
  say(own, touch_t::STOPPED);
  service(1);
  EXPECT_TRUE(call_.has_ended());
  service(2);
  EXPECT_TRUE(taken().empty());
}

TEST(TouchCall, KnowsFinalStatesAndTheirNames) {
  touch_t touch{};
  std::string final_names;
  for (touch.state = touch_t::REFUSED; touch.state <= touch_t::STOPPED; ++touch.state)
    if (is_final(touch)) final_names += std::string(name_of_state(touch)) + ";";
  EXPECT_EQ(final_names, "refused;touched;no contact;stopped;");
  touch.state = 99;
  EXPECT_STREQ(name_of_state(touch), "unknown");
}

}  // namespace
}  // namespace palpate::client
