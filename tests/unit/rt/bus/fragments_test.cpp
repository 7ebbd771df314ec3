#include "rt/bus/fragments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace palpate::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Outcome = FragmentAssembler::Outcome;

void append(Bytes& to, std::uint64_t number, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) to.push_back(static_cast<std::uint8_t>(number >> 8 * i));
}

Bytes fragment(std::uint32_t sequence, std::uint32_t whole, std::uint32_t at, int number, int parts,
               const std::string& channel, const Bytes& part) {
  Bytes datagram{'L', 'C', '0', '3'};
  append(datagram, sequence, 4);
  append(datagram, whole, 4);
  append(datagram, at, 4);
  append(datagram, static_cast<std::uint64_t>(number), 2);
  append(datagram, static_cast<std::uint64_t>(parts), 2);
  if (number == 0)
    datagram.insert(datagram.end(), channel.c_str(), channel.c_str() + channel.size() + 1);
  datagram.insert(datagram.end(), part.begin(), part.end());
  return datagram;
}

Bytes pattern(int size, int seed) {
  Bytes bytes(static_cast<std::size_t>(size));
  std::mt19937 random(static_cast<unsigned>(seed));
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

/// A message in parts of at most `part` bytes.
std::vector<Bytes> in_parts(const std::string& channel, std::uint32_t sequence,
                            const Bytes& payload, int part) {
  const int size = static_cast<int>(payload.size()), parts = (size + part - 1) / part;
  std::vector<Bytes> datagrams;
  for (int i = 0; i < parts; ++i)
    datagrams.push_back(fragment(
        sequence, static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(i * part), i, parts,
        channel,
        Bytes(payload.begin() + i * part, payload.begin() + std::min(size, (i + 1) * part))));
  return datagrams;
}

class Fragments : public ::testing::Test {
 protected:
  Outcome take(const Bytes& datagram, std::uint64_t sender = 1) {
    return assembler_.take(datagram.data(), static_cast<int>(datagram.size()), sender);
  }
  bool is(const std::string& channel, const Bytes& payload) const {
    const UdpmFrame& m = assembler_.message();
    return m.channel == channel && Bytes(m.payload, m.payload + m.payload_size) == payload;
  }
  FragmentAssembler assembler_{10'000};
};

TEST_F(Fragments, InAnyOrderAndOfSeveralSendersAreJoined) {
  const Bytes one = pattern(9'999, 1), two = pattern(9'999, 2);
  std::vector<std::pair<Bytes, int>> all;
  for (const Bytes& d : in_parts("POINT_CLOUD", 7, one, 700)) all.emplace_back(d, 1);
  for (const Bytes& d : in_parts("POINT_CLOUD", 7, two, 700)) all.emplace_back(d, 2);
  std::shuffle(all.begin(), all.end(), std::mt19937(3));
  int whole = 0;
  for (const auto& [datagram, sender] : all) {
    const Outcome outcome = take(datagram, static_cast<std::uint64_t>(sender));
    ASSERT_NE(outcome, Outcome::kDropped);
    if (outcome != Outcome::kWhole) continue;
    ++whole;
    EXPECT_TRUE(is("POINT_CLOUD", sender == 1 ? one : two));
  }
  EXPECT_EQ(whole, 2);
}

TEST_F(Fragments, ThatAreTooLargeMalformedOrInconsistentAreDropped) {
  const Bytes part(100, 1);
  EXPECT_EQ(take(fragment(1, 10'001, 0, 0, 2, "A", part)), Outcome::kDropped) << "beyond the bound";
  EXPECT_EQ(take(fragment(1, 200, 0, 0, 0, "A", part)), Outcome::kDropped) << "no parts";
  EXPECT_EQ(take(fragment(1, 200, 0, 2, 2, "A", part)), Outcome::kDropped) << "part 3 of 2";
  EXPECT_EQ(take(fragment(1, 200, 150, 1, 2, "A", part)), Outcome::kDropped) << "beyond its end";
  EXPECT_EQ(take(fragment(1, 200, 0xffffffff, 1, 2, "A", part)), Outcome::kDropped);
  EXPECT_EQ(take(fragment(1, 200, 0, 0, 2, "", part)), Outcome::kDropped) << "no name";
  EXPECT_EQ(take(fragment(1, 200, 0, 0, 2, std::string(64, 'A'), part)), Outcome::kDropped);
  EXPECT_EQ(take(fragment(1, 200, 0, 0, 5'000, "A", part)), Outcome::kDropped) << "many parts";
  Bytes cut = fragment(1, 200, 0, 1, 2, "A", {});
  cut.resize(19);
  EXPECT_EQ(take(cut), Outcome::kDropped);

  EXPECT_EQ(take(fragment(2, 200, 0, 0, 2, "A", part)), Outcome::kPart);
  EXPECT_EQ(take(fragment(2, 200, 0, 0, 2, "A", part)), Outcome::kDropped) << "twice";
  EXPECT_EQ(take(fragment(2, 200, 50, 1, 2, "A", part)), Outcome::kDropped) << "overlap and gap";
  EXPECT_EQ(take(fragment(3, 200, 0, 0, 2, "A", part)), Outcome::kPart);
  EXPECT_EQ(take(fragment(3, 200, 100, 1, 2, "A", part)), Outcome::kWhole);
}

TEST_F(Fragments, OfMessagesWithoutAnEndMakeRoomForOthers) {
  const Bytes payload = pattern(300, 4);
  for (std::uint32_t i = 0; i < 100; ++i) take(in_parts("LOST", 100 + i, payload, 100)[1]);
  Outcome last = Outcome::kDropped;
  for (const Bytes& datagram : in_parts("FOUND", 7, payload, 100)) last = take(datagram);
  EXPECT_EQ(last, Outcome::kWhole);
  EXPECT_TRUE(is("FOUND", payload));
}

TEST_F(Fragments, AnyBytesStayWithinTheBound) {
  std::mt19937 random(5);
  const std::vector<Bytes> good = in_parts("A", 9, pattern(3'000, 6), 1'000);
  for (int i = 0; i < 20'000; ++i) {
    Bytes datagram = good[random() % good.size()];
    for (unsigned flips = random() % 4; flips > 0; --flips)
      datagram[4 + random() % 20] = static_cast<std::uint8_t>(random());
    datagram.resize(random() % (datagram.size() + 1));
    if (take(datagram, random() % 3) == Outcome::kWhole) {
      EXPECT_LE(assembler_.message().payload_size, 10'000);
    }
  }
}

}  // namespace
}  // namespace palpate::bus
