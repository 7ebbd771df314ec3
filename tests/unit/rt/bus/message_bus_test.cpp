#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <thread>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

ft_wrench_t wrench_number(int number) {
  ft_wrench_t message{};
  message.seq = number;
  for (double& component : message.wrench) component = number;
  return message;
}

Subscription wrench_subscription(int depth) {
  return {"FT_WRENCH", ft_wrench_t().getEncodedSize(), ft_wrench_t::getHash(), depth};
}

void offer(Subscription& subscription, const ft_wrench_t& message, std::int64_t arrival_ns) {
  const auto data = wire::encoded(message);
  subscription.offer(data.data(), static_cast<int>(data.size()), arrival_ns);
}

TEST(Subscription, DeliversInOrderWithTheTimeOfArrival) {
  Subscription subscription = wrench_subscription(4);
  std::vector<std::uint8_t> buffer(static_cast<std::size_t>(subscription.encoded_size()));
  std::int64_t arrival_ns = 0;
  EXPECT_FALSE(wire::take(subscription, buffer.data(), arrival_ns));
  for (int i = 0; i < 3; ++i) offer(subscription, wrench_number(i), 1000 + i);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(wire::take(subscription, buffer.data(), arrival_ns));
    EXPECT_EQ(buffer, wire::encoded(wrench_number(i)));
    EXPECT_EQ(arrival_ns, 1000 + i);
  }
  EXPECT_FALSE(wire::take(subscription, buffer.data(), arrival_ns));
  EXPECT_EQ(subscription.counters().received, 3);
  EXPECT_EQ(subscription.counters().dropped, 0);
}

TEST(Subscription, KeepsTheNewestWhenNoneIsTaken) {
  Subscription subscription = wrench_subscription(5);
  for (int i = 0; i < 100; ++i) offer(subscription, wrench_number(i), i);
  EXPECT_EQ(subscription.counters().received, 100);
  EXPECT_EQ(subscription.counters().dropped, 95);
  std::vector<std::uint8_t> buffer(static_cast<std::size_t>(subscription.encoded_size()));
  for (int i = 95; i < 100; ++i) {
    std::int64_t arrival_ns = 0;
    ASSERT_TRUE(wire::take(subscription, buffer.data(), arrival_ns));
    EXPECT_EQ(arrival_ns, i);
  }
}

TEST(Subscription, HearsOneSenderUntilThatOneIsSilent) {
  Subscription subscription = wrench_subscription(8);
  subscription.lock_to_first_publisher(100);
  const auto offer_of = [&](std::int64_t session, std::int64_t arrival_ns) {
    ft_wrench_t message = wrench_number(1);
    message.session = session;
    offer(subscription, message, arrival_ns);
    return subscription.counters().received.load();
  };
  EXPECT_EQ(offer_of(7, 1000), 1);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(offer_of(8, 1001), 1) << "a concurrent flood";
  EXPECT_EQ(offer_of(7, 1050), 2);
  EXPECT_EQ(offer_of(8, 1149), 2);
  EXPECT_EQ(offer_of(8, 1150), 3) << "nothing of the first for 100 ns";
  EXPECT_EQ(offer_of(8, 1540), 4);
  EXPECT_EQ(offer_of(7, 1549), 5) << "had only paused, and is heard again at once";
  EXPECT_EQ(offer_of(8, 1550), 5);
  EXPECT_EQ(offer_of(8, 1649), 6) << "after another silence";
  EXPECT_EQ(offer_of(8, 2100), 7);
  EXPECT_EQ(offer_of(7, 2150), 7) << "too late: it has ended";
  EXPECT_EQ(subscription.counters().other_sender, 1003);
  EXPECT_EQ(subscription.counters().dropped, 0);
}

TEST(Subscription, RefusesAnotherSizeOrType) {
  Subscription subscription = wrench_subscription(4);
  auto data = wire::encoded(wrench_number(1));
  const int size = static_cast<int>(data.size());
  data.push_back(0);
  subscription.offer(data.data(), size - 1, 0);
  subscription.offer(data.data(), size + 1, 0);
  subscription.offer(data.data(), 7, 0);
  subscription.offer(data.data(), 0, 0);
  subscription.offer(data.data(), -9, 0);
  EXPECT_EQ(subscription.counters().wrong_size, 5);
  const auto other = wire::encoded(imu_t{});
  subscription.offer(other.data(), static_cast<int>(other.size()), 0);
  EXPECT_EQ(subscription.counters().wrong_type, 1);
  EXPECT_EQ(subscription.counters().last_wrong_fingerprint, imu_t::getHash());
  EXPECT_EQ(subscription.counters().received, 0);
  std::int64_t arrival_ns = 0;
  EXPECT_FALSE(wire::take(subscription, data.data(), arrival_ns));
}

TEST(Subscription, RefusesToBeMadeWrong) {
  EXPECT_THROW(Subscription("", 100, 1, 4), std::invalid_argument);
  EXPECT_THROW(Subscription("lower", 100, 1, 4), std::invalid_argument);
  EXPECT_THROW(Subscription("A.*", 100, 1, 4), std::invalid_argument);
  EXPECT_THROW(Subscription(std::string(64, 'A'), 100, 1, 4), std::invalid_argument);
  EXPECT_THROW(Subscription("A", 7, 1, 4), std::invalid_argument);
  EXPECT_THROW(Subscription("A", 100'000, 1, 4), std::invalid_argument);
  EXPECT_THROW(Subscription("A", 100, 1, 0), std::invalid_argument);
}

TEST(Subscription, TwoThreadsLoseOnlyWhatIsCounted) {
  constexpr int kMessages = 100'000;
  Subscription subscription = wrench_subscription(8);
  std::atomic<bool> done{false};
  int taken = 0;
  int torn = 0;
  int out_of_order = 0;
  std::thread consumer([&] {
    std::vector<std::uint8_t> buffer(static_cast<std::size_t>(subscription.encoded_size()));
    ft_wrench_t message{};
    std::int64_t arrival_ns = 0;
    int last = -1;
    for (bool finished = false;;) {
      if (!wire::take(subscription, buffer.data(), arrival_ns)) {
        if (finished) return;
        finished = done;
        continue;
      }
      message.decode(buffer.data(), 0, static_cast<int>(buffer.size()));
      ++taken;
      for (const double component : message.wrench) torn += component == message.seq ? 0 : 1;
      torn += arrival_ns == message.seq ? 0 : 1;
      out_of_order += message.seq > last ? 0 : 1;
      last = message.seq;
    }
  });
  for (int i = 0; i < kMessages; ++i) offer(subscription, wrench_number(i), i);
  done = true;
  consumer.join();
  EXPECT_EQ(subscription.counters().received, kMessages);
  EXPECT_EQ(taken + subscription.counters().dropped, kMessages);
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(out_of_order, 0);
}

TEST(Subscription, NeitherSideAllocates) {
  Subscription subscription = wrench_subscription(4);
  const auto data = wire::encoded(wrench_number(1));
  auto buffer = data;
  std::int64_t arrival_ns = 0;
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 20; ++i) subscription.offer(data.data(), static_cast<int>(data.size()), i);
  while (wire::take(subscription, buffer.data(), arrival_ns)) {
  }
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace palpate::bus
