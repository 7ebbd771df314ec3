#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <sched.h>
#include <sys/wait.h>

#include <chrono>
#include <functional>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/shape_t.hpp>
#include <random>
#include <thread>

#include "rt/bus/lcm_bus.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "tests/process/bus_udpm/injector.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

using wire::Injector;

/// Waits for an action of another thread or process; false on time-out.
bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 20'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

ft_wrench_t wrench_number(int number) {
  ft_wrench_t message{};
  message.seq = number;
  message.session = 1;
  message.wrench[5] = 0.5 * number;
  return message;
}

/// Publishes, slowly enough for any buffer, `count` wrenches over `bus`.
void send_wrenches(MessageBus& bus, int count) {
  TypedPublisher<ft_wrench_t> publisher(bus, "FT_WRENCH");
  for (int i = 0; i < count; ++i) {
    ASSERT_TRUE(publisher.publish(wrench_number(i)));
    if (i % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST(LcmBus, CarriesMessagesBetweenTwoBuses) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  const auto receiver = make_lcm_bus(url.text());
  const auto sender = make_lcm_bus(url.text());
  TypedSubscription<ft_wrench_t> subscription(*receiver, "FT_WRENCH", 1000);
  receiver->start();
  const std::int64_t before = loop::monotonic_ns();
  send_wrenches(*sender, 500);
  ASSERT_TRUE(eventually([&] { return subscription.counters().received == 500; }));
  ft_wrench_t message{};
  std::int64_t arrival_ns = 0;
  std::int64_t last_arrival_ns = before;
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(subscription.take(message, arrival_ns));
    EXPECT_EQ(message.seq, i);
    EXPECT_EQ(message.wrench[5], 0.5 * i);
    EXPECT_GE(arrival_ns, last_arrival_ns);
    last_arrival_ns = arrival_ns;
  }
  EXPECT_LE(last_arrival_ns, loop::monotonic_ns());
  EXPECT_FALSE(subscription.take(message, arrival_ns));
}

TEST(LcmBus, PublishesLaterInOrderAndCountsWhatItCannot) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  const auto receiver = make_lcm_bus(url.text());
  TypedSubscription<ft_wrench_t> subscription(*receiver, "FT_WRENCH", 1000);
  receiver->start();
  constexpr int kMessages = 200;
  {
    const auto sender = make_lcm_bus(url.text());
    sender->start_publisher(kMessages, 200);
    TypedPublisher<ft_wrench_t> publisher(*sender, "FT_WRENCH", Urgency::kLater);
    TypedPublisher<imu_t> now(*sender, "IMU");
    ASSERT_TRUE(now.publish(imu_t{}));  // liblcm creates its lock with the first
    const loop::NoAllocationScope scope;
    for (int i = 0; i < kMessages; ++i) {
      EXPECT_TRUE(publisher.publish(wrench_number(i)));
      EXPECT_TRUE(now.publish(imu_t{}));
    }
    EXPECT_EQ(scope.count(), 0);
    EXPECT_EQ(sender->outlet()->buffer(201), nullptr);
    EXPECT_EQ(sender->unpublished(), 1);
  }  // ends only after everything handed over has been sent
  ASSERT_TRUE(eventually([&] { return subscription.counters().received == kMessages; }));
  ft_wrench_t message{};
  std::int64_t arrival_ns = 0;
  for (int i = 0; i < kMessages; ++i) {
    ASSERT_TRUE(subscription.take(message, arrival_ns));
    EXPECT_EQ(message.seq, i);
  }
}

TEST(LcmBus, WithoutAThreadReceivesInTheCallersAndIsWokenByWhatComes) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  const auto receiver = make_lcm_bus(url.text());
  const auto sender = make_lcm_bus(url.text());
  TypedSubscription<ft_wrench_t> subscription(*receiver, "FT_WRENCH", 100);
  EXPECT_FALSE(receiver->receive(0)) << "not started";
  receiver->start_without_thread();
  EXPECT_FALSE(receiver->receive(0));
  EXPECT_FALSE(receiver->receive(300'000)) << "nothing is sent";

  send_wrenches(*sender, 50);
  EXPECT_EQ(subscription.counters().received, 0) << "not yet received";
  EXPECT_TRUE(receiver->receive(0));
  EXPECT_EQ(subscription.counters().received, 50);

  constexpr std::int64_t kTooLong = 100'000'000'000;  // ns: longer than this test may take
  for (int i = 1; i <= 20; ++i) {
    std::thread late([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(20 * i * i));
      TypedPublisher<ft_wrench_t>(*sender, "FT_WRENCH").publish(wrench_number(i));
    });
    EXPECT_TRUE(receiver->receive(kTooLong));
    late.join();
    EXPECT_EQ(subscription.counters().received, 50 + i);
  }
  receiver->stop();
  EXPECT_FALSE(receiver->receive(0));
}

TEST(LcmBus, HearsWhatStockLibLcmOfAnotherProcessPublishes) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  const auto receiver = make_lcm_bus(url.text());
  TypedSubscription<ft_wrench_t> subscription(*receiver, "FT_WRENCH", 200);
  receiver->start();
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    lcm_t* lcm = lcm_create(url.text().c_str());
    for (int i = 0; lcm != nullptr && i < 100; ++i) {
      const auto data = wire::encoded(wrench_number(i));
      lcm_publish(lcm, "FT_WRENCH", data.data(), static_cast<unsigned>(data.size()));
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    _exit(lcm == nullptr ? 1 : 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  EXPECT_TRUE(eventually([&] { return subscription.counters().received == 100; }));
}

TEST(LcmBus, LargestMessageOfOneDatagramArrivesWholeAndALargerOneIsRefused) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  const auto bus = make_lcm_bus(url.text());
  constexpr int kSize = 60'000;
  std::vector<std::uint8_t> data(kSize + 10'000);
  for (std::size_t i = 8; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i * 31);
  Subscription& subscription = bus->subscribe("SHAPE", kSize, 0, 2);
  bus->start();
  ASSERT_TRUE(bus->publish("SHAPE", data.data(), kSize));
  ASSERT_TRUE(eventually([&] { return subscription.counters().received == 1; }));
  std::vector<std::uint8_t> buffer(kSize);
  std::int64_t arrival_ns = 0;
  ASSERT_TRUE(wire::take(subscription, buffer.data(), arrival_ns));
  data.resize(kSize);
  EXPECT_EQ(buffer, data);
  data.resize(70'000);
  EXPECT_FALSE(bus->publish("SHAPE", data.data(), 70'000));
}

TEST(LcmBus, ReceivesInFragmentsWhatItsBoundAllows) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  constexpr int kSize = 50'000, kAppleFragment = 1423;  // bytes; of LCM on macOS
  std::vector<std::uint8_t> data(kSize);
  for (std::size_t i = 8; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i * 31);
  const auto joins = make_lcm_bus(url.text(), kSize);
  const auto refuses = make_lcm_bus(url.text(), kSize - 1);
  Subscription& subscription = joins->subscribe("CLOUD", kSize, 0, 2);
  Subscription& none = refuses->subscribe("CLOUD", kSize, 0, 2);
  joins->start();
  refuses->start();
  Injector injector(url);
  const auto parts = wire::in_parts("CLOUD", 3, data, kAppleFragment);
  for (const auto& part : parts) ASSERT_TRUE(injector.send(part.data(), part.size()));
  ASSERT_TRUE(eventually([&] { return subscription.counters().received == 1; }));
  std::vector<std::uint8_t> buffer(kSize);
  std::int64_t arrival_ns = 0;
  ASSERT_TRUE(wire::take(subscription, buffer.data(), arrival_ns));
  EXPECT_EQ(buffer, data);
  EXPECT_EQ(joins->datagrams().fragmented, 0);
  const auto count = static_cast<std::int64_t>(parts.size());
  EXPECT_TRUE(eventually([&] { return refuses->datagrams().fragmented == count; }));
  EXPECT_EQ(none.counters().received, 0);
}

TEST(LcmBus, SurvivesAnInjectorOfMalformedPacketsAndStillHearsTheGoodOnes) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  const auto bus = make_lcm_bus(url.text());
  TypedSubscription<ft_wrench_t> subscription(*bus, "FT_WRENCH", 4000);
  bus->start();
  Injector injector(url);
  const auto send = [&](const std::vector<std::uint8_t>& data) {
    ASSERT_TRUE(injector.send(data.data(), data.size()));
  };
  const auto good = wire::encoded(wrench_number(1));
  auto wrong_type = good;
  wrong_type[0] ^= 1;
  auto cut_short = wire::datagram("FT_WRENCH", {});
  cut_short.pop_back();  // liblcm computes a payload of -1 bytes from a name without end
  std::vector<std::uint8_t> wrapping = wire::datagram("FT_WRENCH", {}, "LC03");
  wrapping.insert(wrapping.begin() + 8, {0, 0, 4, 0, 0xff, 0xff, 0xff, 0xc0, 0, 1, 0, 2});
  std::mt19937 random(3);
  constexpr int kRounds = 2000;
  for (int round = 0; round < kRounds; ++round) {
    send(wire::datagram("FT_WRENCH", good, "LC01"));
    send(cut_short);
    send(wrapping);
    send(wire::datagram("FT_WRENCH", wrong_type));
    send(wire::datagram("FT_WRENCH", std::vector<std::uint8_t>(round % 2 == 0 ? 9 : 60'000)));
    std::vector<std::uint8_t> noise(random() % 1500);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
    send(noise);
    send(wire::datagram("FT_WRENCH", good));
    if (round % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const DatagramCounters& seen = bus->datagrams();
  // UDP may lose some at this rate; losses are counted by the kernel.
  ASSERT_TRUE(eventually([&] {
    send(wire::datagram("FT_WRENCH", good));
    return seen.received + seen.overflowed >= 7 * kRounds;
  }));
  const SubscriptionCounters& wrench = subscription.counters();
  EXPECT_GT(seen.malformed, kRounds);
  EXPECT_GT(seen.fragmented, kRounds / 10);
  EXPECT_GT(wrench.wrong_type, kRounds / 10);
  EXPECT_GT(wrench.received, kRounds / 10);
  ft_wrench_t message{};
  std::int64_t arrival_ns = 0;
  while (subscription.take(message, arrival_ns)) {
    ASSERT_EQ(message.seq, 1);
    ASSERT_EQ(message.wrench[5], 0.5);
  }
}

TEST(UdpmReceiver, StopsAndStartsAgainWithTheBufferThatTheUrlAsksFor) {
  UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  DatagramCounters counters;
  UdpmReceiver receiver(counters);
  Subscription& subscription =
      receiver.subscribe("FT_WRENCH", ft_wrench_t().getEncodedSize(), ft_wrench_t::getHash(), 4);
  url.receive_buffer_size = 20'000;
  receiver.start(url);
  EXPECT_EQ(receiver.receive_buffer_size(), 20'000);
  EXPECT_THROW(receiver.subscribe("IMU", 100, 1, 1), std::logic_error);
  receiver.stop();
  receiver.stop();
  url.receive_buffer_size = 0;
  receiver.start(url);
  EXPECT_GT(receiver.receive_buffer_size(), 20'000);
  Injector injector(url);
  const auto good = wire::datagram("FT_WRENCH", wire::encoded(wrench_number(1)));
  EXPECT_TRUE(eventually([&] {
    injector.send(good.data(), good.size());
    return subscription.counters().received > 0;
  }));
}

TEST(UdpmReceiver, CountsWhatItsSocketCouldNotHold) {
  UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  url.receive_buffer_size = 5000;
  DatagramCounters counters;
  UdpmReceiver receiver(counters);
  receiver.start(url);
  Injector injector(url);
  const std::vector<std::uint8_t> large(20'000);
  std::int64_t sent = 0;
  // A burst overruns the receiver eventually.
  ASSERT_TRUE(eventually([&] {
    for (int i = 0; i < 200; ++i, ++sent) injector.send(large.data(), large.size());
    return counters.overflowed > 0;
  }));
  EXPECT_LE(counters.received + counters.overflowed, sent);
}

TEST(LcmBus, PublishingDoesNotAllocate) {
  const UdpmUrl url = private_url();
  PALPATE_REQUIRE_MULTICAST(url);
  const auto bus = make_lcm_bus(url.text());
  TypedPublisher<ft_wrench_t> publisher(*bus, "FT_WRENCH");
  publisher.publish(wrench_number(0));
  const ft_wrench_t message = wrench_number(1);
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 100; ++i) publisher.publish(message);
  EXPECT_EQ(scope.count(), 0);
}

TEST(LcmBus, WithoutARouteItSaysHowToAddOne) {
  // A child in a separate network without any route.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0 && unshare(CLONE_NEWNET) != 0) _exit(77);
    try {
      make_lcm_bus("udpm://239.255.76.67:7667?ttl=0");
      _exit(1);
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      _exit(text.find("ip route add 224.0.0.0/4 dev lo") != std::string::npos ? 0 : 2);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
    GTEST_SKIP() << "a network namespace is not granted";
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace palpate::bus
