#include "rt/bus/fragments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

using wire::fragment;
using wire::in_parts;
using Bytes = std::vector<std::uint8_t>;

Bytes pattern(int size, int seed) {
  Bytes bytes(static_cast<std::size_t>(size));
  std::mt19937 random(static_cast<unsigned>(seed));
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

class Fragments : public ::testing::Test {
 protected:
  /// Whether the datagram completes a message.
  bool take(const Bytes& datagram, std::uint64_t sender = 1, std::int64_t arrival_ns = 0) {
    return assembler_.take(datagram.data(), static_cast<int>(datagram.size()), sender, arrival_ns,
                           counters_, frame_);
  }
  /// Whether the datagram is dropped, at once and alone.
  bool drops(const Bytes& datagram) {
    const std::int64_t before = counters_.fragmented;
    return !take(datagram) && counters_.fragmented == before + 1;
  }
  bool is(const std::string& channel, const Bytes& payload) const {
    return frame_.channel == channel &&
           Bytes(frame_.payload, frame_.payload + frame_.payload_size) == payload;
  }
  FragmentAssembler assembler_{10'000};
  DatagramCounters counters_;
  UdpmFrame frame_{};
};

TEST_F(Fragments, InAnyOrderAndOfSeveralSendersAreJoined) {
  const Bytes one = pattern(9'999, 1), two = pattern(9'999, 2);
  std::vector<std::pair<Bytes, int>> all;
  for (const Bytes& d : in_parts("POINT_CLOUD", 7, one, 700)) all.emplace_back(d, 1);
  for (const Bytes& d : in_parts("POINT_CLOUD", 7, two, 700)) all.emplace_back(d, 2);
  std::shuffle(all.begin(), all.end(), std::mt19937(3));
  int whole = 0;
  for (const auto& [datagram, sender] : all) {
    if (!take(datagram, static_cast<std::uint64_t>(sender))) continue;
    ++whole;
    EXPECT_TRUE(is("POINT_CLOUD", sender == 1 ? one : two));
  }
  EXPECT_EQ(whole, 2);
  EXPECT_EQ(counters_.received, 30);
  EXPECT_EQ(counters_.fragmented, 0);
}

TEST_F(Fragments, ThatAreTooLargeMalformedOrInconsistentAreDropped) {
  const Bytes part(100, 1);
  EXPECT_TRUE(drops(fragment(1, 10'001, 0, 0, 2, "A", part))) << "beyond the bound";
  EXPECT_TRUE(drops(fragment(1, 200, 0, 0, 0, "A", part))) << "no parts";
  EXPECT_TRUE(drops(fragment(1, 200, 0, 2, 2, "A", part))) << "part 3 of 2";
  EXPECT_TRUE(drops(fragment(1, 200, 150, 1, 2, "A", part))) << "beyond its end";
  EXPECT_TRUE(drops(fragment(1, 200, 0xffffffff, 1, 2, "A", part)));
  EXPECT_TRUE(drops(fragment(1, 200, 0, 0, 2, "", part))) << "no name";
  EXPECT_TRUE(drops(fragment(1, 200, 0, 0, 2, std::string(64, 'A'), part)));
  EXPECT_TRUE(drops(fragment(1, 200, 0, 0, 5'000, "A", part))) << "many parts";
  Bytes cut = fragment(1, 200, 0, 1, 2, "A", {});
  cut.resize(19);
  EXPECT_TRUE(drops(cut));
  EXPECT_EQ(counters_.fragmented, 9);

  EXPECT_FALSE(take(fragment(2, 200, 0, 0, 2, "A", part)));
  EXPECT_EQ(counters_.fragmented, 9) << "waits for the other part";
  EXPECT_TRUE(drops(fragment(2, 200, 0, 0, 2, "A", part))) << "twice";
  EXPECT_FALSE(take(fragment(2, 200, 50, 1, 2, "A", part)));
  EXPECT_EQ(counters_.fragmented, 12) << "both parts of a message with overlap and gap";
  EXPECT_FALSE(take(fragment(3, 200, 0, 0, 2, "A", part)));
  EXPECT_TRUE(take(fragment(3, 200, 100, 1, 2, "A", part)));
  EXPECT_EQ(counters_.fragmented, 12);
}

TEST_F(Fragments, OfMessagesWithoutAnEndMakeRoomForOthersAndAreCounted) {
  const Bytes payload = pattern(300, 4);
  for (std::uint32_t i = 0; i < 100; ++i)
    EXPECT_FALSE(take(in_parts("LOST", 100 + i, payload, 100)[1], 1, i));
  EXPECT_EQ(counters_.fragmented, 100 - FragmentAssembler::kMost);
  bool whole = false;
  for (const Bytes& datagram : in_parts("FOUND", 7, payload, 100)) whole = take(datagram, 1, 100);
  EXPECT_TRUE(whole);
  EXPECT_TRUE(is("FOUND", payload));
  EXPECT_EQ(counters_.fragmented, 101 - FragmentAssembler::kMost);
}

TEST_F(Fragments, ThatComeLateAreNotJoined) {
  const Bytes payload = pattern(200, 8);
  const auto parts = in_parts("A", 1, payload, 100);
  EXPECT_FALSE(take(parts[0], 1, 5));
  EXPECT_FALSE(take(parts[1], 1, 6 + FragmentAssembler::kLongest)) << "waits for the first again";
  EXPECT_EQ(counters_.fragmented, 1) << "the first part, given up";
  EXPECT_TRUE(take(parts[0], 1, 6 + 2 * FragmentAssembler::kLongest));
  EXPECT_TRUE(is("A", payload));
}

/// Good messages with changed, cut, repeated and missing fragments: every datagram is part of a
/// message, dropped, or still waiting; nothing is read beyond a datagram or written beyond the
/// bound.
TEST_F(Fragments, MalformedInAnyWayStayWithinTheBoundAndAreAccountedFor) {
  std::mt19937 random(5);
  const auto below = [&random](std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  };
  const Bytes payload = pattern(3'000, 6);
  std::int64_t sent = 0, joined = 0, messages = 0;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    auto parts = in_parts("A", i, payload, 1'000);
    std::shuffle(parts.begin(), parts.end(), random);
    for (Bytes& part : parts) {
      for (std::size_t flips = below(8); flips > 5; --flips)
        part[4 + below(20)] = static_cast<std::uint8_t>(random());
      if (below(8) == 0) part.resize(below(part.size() + 1));
      part.shrink_to_fit();
      if (below(16) == 0) continue;
      const int count = part.size() < 20 ? 0 : part[18] << 8 | part[19];
      for (std::size_t times = below(16) == 0 ? 2 : 1; times > 0; --times, ++sent) {
        if (!take(part, below(8) == 0 ? 2 : 1, i)) continue;
        ASSERT_LE(frame_.payload_size, 10'000);
        ASSERT_FALSE(frame_.channel.empty());
        joined += count;
        ++messages;
      }
    }
  }
  EXPECT_EQ(counters_.received, sent);
  EXPECT_GT(messages, 1'000);
  EXPECT_GT(counters_.fragmented, 10'000);
  const std::int64_t waiting = sent - joined - counters_.fragmented;
  EXPECT_GE(waiting, 0);
  EXPECT_LE(waiting, FragmentAssembler::kMost * 3) << "three parts have a place in a message";
}

}  // namespace
}  // namespace palpate::bus
