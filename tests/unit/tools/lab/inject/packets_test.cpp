#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "rt/bus/lcm_bus.hpp"
#include "tools/lab/inject/packets.hpp"

namespace palpate::inject {
namespace {

/// Channels to which palpated subscribes.
std::vector<Target> heard_targets() {
  std::vector<Target> targets = usual_targets();
  targets.erase(std::remove_if(targets.begin(), targets.end(),
                               [](const Target& one) { return one.channel == "SHAPE"; }),
                targets.end());
  return targets;
}

struct Listener {
  Listener() : receiver(counters) {
    for (const Target& target : heard_targets())
      subscriptions.push_back(
          &receiver.subscribe(target.channel, target.encoded_size, target.fingerprint, 4));
  }
  void hear(const std::vector<std::uint8_t>& datagram) {
    receiver.handle(datagram.data(), static_cast<int>(datagram.size()), 1);
  }
  std::int64_t accepted() const {
    std::int64_t sum = 0;
    for (const bus::Subscription* one : subscriptions) sum += one->counters().received;
    return sum;
  }
  std::int64_t wrong() const {
    std::int64_t sum = 0;
    for (const bus::Subscription* one : subscriptions)
      sum += one->counters().wrong_size + one->counters().wrong_type;
    return sum;
  }
  bus::DatagramCounters counters;
  bus::UdpmReceiver receiver;
  std::vector<bus::Subscription*> subscriptions;
};

class EachKind : public ::testing::TestWithParam<int> {};

TEST_P(EachKind, IsDroppedAndCounted) {
  const auto kind = static_cast<Kind>(GetParam());
  constexpr int kCount = 3000;
  Listener listener;
  PacketSource source(7, {kind}, kind == Kind::kRandomPayload ? heard_targets() : usual_targets());
  for (int i = 0; i < kCount; ++i) {
    const auto& datagram = source.next();
    EXPECT_EQ(source.kind(), kind);
    ASSERT_LE(datagram.size(), 65507U);
    listener.hear(datagram);
  }
  const std::int64_t dropped = listener.counters.malformed + listener.counters.fragmented +
                               listener.counters.unsubscribed + listener.wrong();
  if (kind == Kind::kRandomPayload) {
    EXPECT_EQ(listener.accepted(), kCount);
    EXPECT_EQ(dropped, 0);
  } else {
    EXPECT_EQ(listener.accepted(), 0);
    EXPECT_EQ(dropped, kCount);
  }
}

std::string name_of(const ::testing::TestParamInfo<int>& info) {
  return name(static_cast<Kind>(info.param));
}
INSTANTIATE_TEST_SUITE_P(Packets, EachKind, ::testing::Range(0, kKinds), name_of);

TEST(PacketSource, SameSeedSamePackets) {
  PacketSource a(3, malformed_kinds(), usual_targets());
  PacketSource b(3, malformed_kinds(), usual_targets());
  PacketSource other(4, malformed_kinds(), usual_targets());
  int different = 0;
  std::set<Kind> seen;
  for (int i = 0; i < 2000; ++i) {
    const auto datagram = a.next();
    ASSERT_EQ(datagram, b.next());
    different += datagram != other.next() ? 1 : 0;
    seen.insert(a.kind());
  }
  EXPECT_GT(different, 1900);
  EXPECT_EQ(seen.size(), malformed_kinds().size());
}

TEST(PacketSource, KindsHaveNames) {
  for (int i = 0; i < kKinds; ++i)
    EXPECT_EQ(kind_from(name(static_cast<Kind>(i))), static_cast<Kind>(i));
  EXPECT_THROW(kind_from("no_such"), std::invalid_argument);
  EXPECT_THROW(PacketSource(1, {}, usual_targets()), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::inject
