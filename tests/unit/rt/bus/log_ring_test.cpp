#include "rt/bus/log_ring.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>

namespace palpate::bus {
namespace {

struct Event {
  std::int64_t time_us;
  std::string channel, data;
};

/// Contents of the ring as read by liblcm's own reader.
std::vector<Event> read_back(const LogRing& ring) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("palpate_log_ring_" + std::to_string(getpid()) + ".lcmlog");
  std::ofstream file(path, std::ios::binary);
  for (const LogRing::Piece& piece : ring.pieces())
    file.write(reinterpret_cast<const char*>(piece.data), static_cast<std::streamsize>(piece.size));
  file.close();
  std::vector<Event> events;
  {
    lcm::LogFile log(path.string(), "r");
    while (const lcm::LogEvent* event = log.readNextEvent())
      events.push_back(
          {event->timestamp,
           event->channel,
           {static_cast<const char*>(event->data), static_cast<std::size_t>(event->datalen)}});
  }
  std::filesystem::remove(path);
  return events;
}

TEST(LogRing, LiblcmReadsWhatWasAdded) {
  LogRing ring(1000, 1);
  const std::string data("a\0b\xff", 4);
  ring.add(1'700'000'000'000'001, "FT_WRENCH", data.data(), 4);
  ring.add(1'700'000'000'000'002, "IMU", "", 0);
  const std::vector<Event> events = read_back(ring);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].time_us, 1'700'000'000'000'001);
  EXPECT_EQ(events[0].channel, "FT_WRENCH");
  EXPECT_EQ(events[0].data, data);
  EXPECT_EQ(events[1].channel, "IMU");
  EXPECT_EQ(events[1].data, "");
}

// Sizes are coprime to the ring's size, so that each of its bytes becomes an event border once.
TEST(LogRing, FullRoomHoldsTheNewestWholeEvents) {
  LogRing ring(997, 1e6);
  for (int i = 0; i < 3000; ++i) {
    const std::string data(static_cast<std::size_t>(i % 61), static_cast<char>('a' + i % 26));
    ring.add(i, i % 2 == 0 ? "EVEN" : "ODD", data.data(), static_cast<int>(data.size()));
    if (i % 50 != 49) continue;
    const std::vector<Event> events = read_back(ring);
    ASSERT_GT(events.size(), 5u);
    std::size_t used = 0;
    for (std::size_t k = 0; k < events.size(); ++k) {
      const int n = i + 1 - static_cast<int>(events.size() - k);
      ASSERT_EQ(events[k].time_us, n);
      ASSERT_EQ(events[k].channel, n % 2 == 0 ? "EVEN" : "ODD");
      ASSERT_EQ(events[k].data,
                std::string(static_cast<std::size_t>(n % 61), static_cast<char>('a' + n % 26)));
      used += 28 + events[k].channel.size() + events[k].data.size();
    }
    ASSERT_LE(used, 997u);
    ASSERT_GT(used, 997u - 2 * (28 + 4 + 61)) << "gives more away than it must";
  }
}

TEST(LogRing, WhatIsOlderThanTheSpanGoes) {
  LogRing ring(100000, 0.010);
  for (int ms = 0; ms < 100; ++ms) ring.add(1000 * ms, "A", "x", 1);
  const std::vector<Event> events = read_back(ring);
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.front().time_us, 89'000);
  EXPECT_EQ(events.back().time_us, 99'000);
}

TEST(LogRing, AnEventLargerThanTheRoomIsLeftOutAndNothingElse) {
  LogRing ring(100, 1);
  ring.add(1, "A", "small", 5);
  const std::string large(200, 'x');
  ring.add(2, "A", large.data(), 200);
  const std::vector<Event> events = read_back(ring);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].data, "small");
  ring.clear();
  EXPECT_TRUE(read_back(ring).empty());
  EXPECT_THROW(LogRing(0, 1), std::invalid_argument);
  EXPECT_THROW(LogRing(10, 0), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::bus
