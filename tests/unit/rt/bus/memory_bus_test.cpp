#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/shape_t.hpp>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

TEST(MemoryBus, DeliversToEverySubscriptionOfTheChannelAtTheHubsTime) {
  const auto hub = make_memory_hub();
  const auto sender = make_memory_bus(hub);
  const auto receiver = make_memory_bus(hub);
  TypedSubscription<ft_wrench_t> own(*sender, "FT_WRENCH", 4);
  TypedSubscription<ft_wrench_t> first(*receiver, "FT_WRENCH", 4);
  TypedSubscription<ft_wrench_t> second(*receiver, "FT_WRENCH", 4);
  TypedSubscription<ft_wrench_t> other(*receiver, "FT_WRENCH_1", 4);
  TypedPublisher<ft_wrench_t> publisher(*sender, "FT_WRENCH");
  ft_wrench_t sent{};
  sent.seq = 7;
  sent.wrench[2] = -4.5;
  set_time(*hub, 123456);
  ASSERT_TRUE(publisher.publish(sent));
  set_time(*hub, 999999);
  for (auto* subscription : {&own, &first, &second}) {
    ft_wrench_t received{};
    std::int64_t arrival_ns = 0;
    ASSERT_TRUE(subscription->take(received, arrival_ns));
    EXPECT_EQ(received.seq, 7);
    EXPECT_EQ(received.wrench[2], -4.5);
    EXPECT_EQ(arrival_ns, 123456);
    EXPECT_FALSE(subscription->take(received, arrival_ns));
  }
  EXPECT_EQ(other.counters().received, 0);
}

TEST(MemoryBus, RefusesTheWrongTypeAsTheNetworkWould) {
  const auto hub = make_memory_hub();
  const auto bus = make_memory_bus(hub);
  TypedSubscription<ft_wrench_t> subscription(*bus, "FT_WRENCH", 4);
  TypedPublisher<imu_t> publisher(*bus, "FT_WRENCH");
  EXPECT_TRUE(publisher.publish(imu_t{}));
  EXPECT_EQ(subscription.counters().wrong_type, 1);
}

TEST(MemoryBus, RefusesWhatDoesNotFitOneDatagramAsTheNetworkWould) {
  const auto hub = make_memory_hub();
  const auto bus = make_memory_bus(hub);
  std::vector<Published> published;
  record(*hub, &published);
  const std::vector<std::uint8_t> data(70'000);
  EXPECT_TRUE(bus->publish("SHAPE", data.data(), 60'000));
  EXPECT_TRUE(bus->publish("SHAPE", data.data(), 65'499 - 6));
  EXPECT_FALSE(bus->publish("SHAPE", data.data(), 65'500 - 6));
  EXPECT_FALSE(bus->publish("", data.data(), 10));
  EXPECT_FALSE(bus->publish(std::string(64, 'A').c_str(), data.data(), 10));
  EXPECT_EQ(published.size(), 2u);
}

TEST(MemoryBus, RecordsWhatIsPublishedWhileAsked) {
  const auto hub = make_memory_hub();
  const auto bus = make_memory_bus(hub);
  TypedPublisher<ft_wrench_t> publisher(*bus, "FT_WRENCH");
  publisher.publish(ft_wrench_t{});
  std::vector<Published> published;
  record(*hub, &published);
  set_time(*hub, 5);
  ft_wrench_t sent{};
  sent.seq = 3;
  publisher.publish(sent);
  record(*hub, nullptr);
  publisher.publish(sent);
  ASSERT_EQ(published.size(), 1u);
  EXPECT_EQ(published[0].channel, "FT_WRENCH");
  EXPECT_EQ(published[0].data, wire::encoded(sent));
  EXPECT_EQ(published[0].time_ns, 5);
}

TEST(MemoryBus, AParticipantMayLeave) {
  const auto hub = make_memory_hub();
  const auto stays = make_memory_bus(hub);
  {
    const auto leaves = make_memory_bus(hub);
    TypedSubscription<ft_wrench_t> subscription(*leaves, "FT_WRENCH", 4);
  }
  TypedPublisher<ft_wrench_t> publisher(*stays, "FT_WRENCH");
  EXPECT_TRUE(publisher.publish(ft_wrench_t{}));
}

TEST(MemoryBus, PublishingAndTakingAFixedTypeDoesNotAllocate) {
  const auto hub = make_memory_hub();
  const auto bus = make_memory_bus(hub);
  TypedSubscription<ft_wrench_t> subscription(*bus, "FT_WRENCH", 4);
  TypedPublisher<ft_wrench_t> publisher(*bus, "FT_WRENCH");
  ft_wrench_t message{};
  std::int64_t arrival_ns = 0;
  publisher.publish(message);  // the type's fingerprint is computed at its first use
  subscription.take(message, arrival_ns);
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 10; ++i) publisher.publish(message);
  while (subscription.take(message, arrival_ns)) {
  }
  EXPECT_EQ(scope.count(), 0);
}

TEST(TypedPublisher, AVariableTypeDoesNotAllocateWithinWhatIsReserved) {
  const auto hub = make_memory_hub();
  const auto bus = make_memory_bus(hub);
  TypedPublisher<shape_t> publisher(*bus, "SHAPE");
  shape_t shape{};
  shape.xyz_count = 3000;
  shape.xyz.resize(3000);
  publisher.reserve(shape.getEncodedSize());
  const loop::NoAllocationScope scope;
  EXPECT_TRUE(publisher.publish(shape));
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace palpate::bus
