#include "rt/bus/lcm_bus.hpp"

#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>
#include <random>

#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Whether `data` is a short message; counted.
bool parse(const Bytes& data, DatagramCounters& counters, UdpmFrame& frame) {
  return parse_udpm_frame(data.data(), static_cast<int>(data.size()), counters, frame);
}

TEST(UdpmFrame, FindsChannelAndPayload) {
  const auto data = wire::datagram("FT_WRENCH", {1, 2, 3});
  DatagramCounters counters;
  UdpmFrame frame{};
  ASSERT_TRUE(parse(data, counters, frame));
  EXPECT_EQ(frame.channel, "FT_WRENCH");
  ASSERT_EQ(frame.payload_size, 3);
  EXPECT_EQ(frame.payload[0], 1);
  EXPECT_EQ(frame.payload[2], 3);
  EXPECT_EQ(counters.received, 1);
}

TEST(UdpmFrame, APayloadMayBeEmptyAndANameSixtyThreeLong) {
  const auto data = wire::datagram(std::string(63, 'A'), {});
  DatagramCounters counters;
  UdpmFrame frame{};
  ASSERT_TRUE(parse(data, counters, frame));
  EXPECT_EQ(frame.channel.size(), 63u);
  EXPECT_EQ(frame.payload_size, 0);
}

TEST(UdpmFrame, DistinguishesAFragmentFromNonsense) {
  DatagramCounters counters;
  UdpmFrame frame{};
  EXPECT_FALSE(parse(wire::datagram("A", {1}, "LC03"), counters, frame));
  EXPECT_EQ(counters.fragmented, 1);
  const Bytes nonsense[] = {wire::datagram("A", {1}, "LC01"),
                            wire::datagram("A", {1}, "XXXX"),
                            wire::datagram("", {1}),
                            wire::datagram(std::string(64, 'A'), {1}),
                            {'L', 'C', '0', '3'}};
  for (const Bytes& data : nonsense) EXPECT_FALSE(parse(data, counters, frame));
  EXPECT_EQ(counters.malformed, 5);
  EXPECT_EQ(counters.fragmented, 1);
  EXPECT_EQ(counters.received, 6);
}

TEST(UdpmFrame, NeverSeesMoreThanThereIs) {
  const auto whole = wire::datagram("FT_WRENCH", {1, 2, 3, 4, 5});
  const std::size_t name_ends = 8 + 9 + 1;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    DatagramCounters counters;
    UdpmFrame frame{};
    const bool is_message = parse(cut, counters, frame);
    EXPECT_EQ(is_message, size >= name_ends) << size;
    EXPECT_EQ(counters.malformed, size < name_ends ? 1 : 0) << size;
    if (!is_message) continue;
    EXPECT_EQ(frame.payload_size, static_cast<int>(size - name_ends));
  }
}

class UdpmReceiverTest : public ::testing::Test {
 protected:
  void hand(const Bytes& data) {
    const Bytes exact(data.begin(), data.end());
    receiver_.handle(exact.data(), static_cast<int>(exact.size()), 42);
  }
  const SubscriptionCounters& seen() const { return wrench_.counters(); }
  bool holds_nothing() {
    std::int64_t arrival_ns = 0;
    Bytes buffer(static_cast<std::size_t>(wrench_.encoded_size()));
    return !wire::take(wrench_, buffer.data(), arrival_ns);
  }

  const Bytes good_ = wire::encoded(ft_wrench_t{});
  DatagramCounters counters_;
  UdpmReceiver receiver_{counters_};
  Subscription& wrench_ =
      receiver_.subscribe("FT_WRENCH", ft_wrench_t().getEncodedSize(), ft_wrench_t::getHash(), 8);
};

TEST_F(UdpmReceiverTest, PassesAGoodMessageOn) {
  hand(wire::datagram("FT_WRENCH", good_));
  Bytes buffer(good_.size());
  std::int64_t arrival_ns = 0;
  ASSERT_TRUE(wire::take(wrench_, buffer.data(), arrival_ns));
  EXPECT_EQ(buffer, good_);
  EXPECT_EQ(arrival_ns, 42);
  EXPECT_EQ(counters_.received, 1);
  EXPECT_EQ(counters_.malformed + counters_.fragmented + counters_.unsubscribed, 0);
}

TEST_F(UdpmReceiverTest, CountsEachKindOfBadDatagram) {
  hand({});
  hand(wire::datagram("FT_WRENCH", good_, "LC99"));
  EXPECT_EQ(counters_.malformed, 2);
  hand(wire::datagram("FT_WRENCH", good_, "LC03"));
  EXPECT_EQ(counters_.fragmented, 1);
  hand(wire::datagram("FT_WRENCH_1", good_));
  hand(wire::datagram("FT", good_));
  EXPECT_EQ(counters_.unsubscribed, 2);
  Bytes longer = good_;
  longer.resize(60'000);
  hand(wire::datagram("FT_WRENCH", longer));
  hand(wire::datagram("FT_WRENCH", {}));
  EXPECT_EQ(seen().wrong_size, 2);
  Bytes other_type = good_;
  other_type[3] ^= 0xff;
  hand(wire::datagram("FT_WRENCH", other_type));
  EXPECT_EQ(seen().wrong_type, 1);
  EXPECT_EQ(counters_.received, 8);
  EXPECT_TRUE(holds_nothing());
}

TEST_F(UdpmReceiverTest, SurvivesRandomAndMutatedDatagramsAndAccountsForEach) {
  std::mt19937 random(20);
  const auto below = [&random](std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  };
  const Bytes whole = wire::datagram("FT_WRENCH", good_);
  constexpr std::int64_t kDatagrams = 200'000;
  for (std::int64_t i = 0; i < kDatagrams; ++i) {
    Bytes data = whole;
    if (i % 4 == 0) {  // random noise only
      data.resize(below(200));
      for (auto& byte : data) byte = static_cast<std::uint8_t>(random());
    } else {  // a valid one with a few bytes changed, truncated or extended
      for (std::size_t change = below(4); change > 0; --change)
        data[below(data.size())] = static_cast<std::uint8_t>(random());
      if (i % 4 == 2) data.resize(below(data.size() + 1));
      if (i % 4 == 3) data.resize(data.size() + below(300));
    }
    hand(data);
  }
  EXPECT_EQ(counters_.received, kDatagrams);
  EXPECT_EQ(counters_.malformed + counters_.fragmented + counters_.unsubscribed + seen().received +
                seen().wrong_size + seen().wrong_type,
            kDatagrams);
  EXPECT_GT(counters_.malformed, kDatagrams / 4 - 100);
  EXPECT_GT(seen().wrong_size, 1000);
  EXPECT_GT(seen().wrong_type, 1000);
  EXPECT_GT(seen().received, 1000);
}

class JoiningReceiver : public ::testing::Test {
 protected:
  static constexpr int kLargest = 1000;

  void hand(const std::vector<Bytes>& datagrams, std::uint64_t sender = 1) {
    for (const Bytes& data : datagrams)
      receiver_.handle(data.data(), static_cast<int>(data.size()), 42, sender);
  }
  std::vector<Bytes> fragments(const std::string& channel, const Bytes& payload) {
    return wire::in_parts(channel, ++sequence_, payload, 30);
  }

  const Bytes good_ = wire::encoded(ft_wrench_t{});
  std::uint32_t sequence_ = 0;
  DatagramCounters counters_;
  UdpmReceiver receiver_{counters_, kLargest};
  Subscription& wrench_ =
      receiver_.subscribe("FT_WRENCH", static_cast<int>(good_.size()), ft_wrench_t::getHash(), 8);
};

TEST_F(JoiningReceiver, PassesMessagesOfSeveralFragmentsOnAndChecksThemLikeOthers) {
  const auto parts = fragments("FT_WRENCH", good_);
  ASSERT_GT(parts.size(), 2u);
  hand(parts);
  hand({wire::datagram("FT_WRENCH", good_)});
  Bytes buffer(good_.size());
  std::int64_t arrival_ns = 0;
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(wire::take(wrench_, buffer.data(), arrival_ns));
    EXPECT_EQ(buffer, good_);
    EXPECT_EQ(arrival_ns, 42);
  }
  EXPECT_EQ(counters_.received, static_cast<std::int64_t>(parts.size()) + 1);
  EXPECT_EQ(counters_.malformed + counters_.fragmented + counters_.unsubscribed, 0);

  hand(fragments("IMU", good_));
  EXPECT_EQ(counters_.unsubscribed, 1);
  Bytes other = good_;
  other.resize(kLargest);
  hand(fragments("FT_WRENCH", other));
  EXPECT_EQ(wrench_.counters().wrong_size, 1);
  other[3] ^= 0xff;
  hand(fragments("FT_WRENCH", other));
  EXPECT_EQ(wrench_.counters().wrong_type, 1);
  EXPECT_EQ(counters_.fragmented, 0);
  other.resize(kLargest + 1);
  const auto too_large = fragments("FT_WRENCH", other);
  hand(too_large);
  EXPECT_EQ(counters_.fragmented, static_cast<std::int64_t>(too_large.size()));
  EXPECT_FALSE(wire::take(wrench_, buffer.data(), arrival_ns));
}

TEST_F(JoiningReceiver, SurvivesMutatedFragmentsAndNeverAllocates) {
  std::mt19937 random(21);
  std::vector<Bytes> datagrams;
  for (int i = 0; i < 20'000; ++i) {
    for (Bytes& data : fragments("FT_WRENCH", good_)) {
      if (random() % 4 == 0) data[random() % data.size()] = static_cast<std::uint8_t>(random());
      if (random() % 16 == 0) data.resize(random() % data.size());
      data.shrink_to_fit();
      if (random() % 16 > 0) datagrams.push_back(std::move(data));
    }
  }
  const loop::NoAllocationScope scope;
  hand(datagrams);
  EXPECT_EQ(scope.count(), 0);
  EXPECT_EQ(counters_.received, static_cast<std::int64_t>(datagrams.size()));
  EXPECT_GT(counters_.fragmented, 1000);
  EXPECT_GT(counters_.malformed, 1000) << "cut before or within the magic number";
  EXPECT_GT(wrench_.counters().received, 1000);
  EXPECT_LT(wrench_.counters().received, 20'000);
}

TEST_F(UdpmReceiverTest, NeverAllocates) {
  const Bytes good = wire::datagram("FT_WRENCH", good_);
  const Bytes stranger = wire::datagram("IMU", good_);
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 100; ++i) {
    receiver_.handle(good.data(), static_cast<int>(good.size()), i);
    receiver_.handle(stranger.data(), static_cast<int>(stranger.size()), i);
    receiver_.handle(good.data(), static_cast<int>(good.size()) - 1, i);
  }
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace palpate::bus
