#include "tools/top/channel_table.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <palpate/ft_wrench_t.hpp>

#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::top {
namespace {

constexpr std::int64_t kMs = 1'000'000;                // ns
constexpr std::int64_t kWall = 1'700'000'000'000'000;  // us

class Feed {
 public:
  explicit Feed(ChannelTable& table, int source = 0, std::string channel = "FT_WRENCH")
      : table_(table), source_(source), channel_(std::move(channel)) {}
  /// A message numbered `seq` that arrives at `ns`, `latency_us` after it was sent.
  void take(std::int32_t seq, std::int64_t ns, std::int64_t latency_us = 0) {
    ft_wrench_t message{};
    message.seq = seq;
    message.session = 9;
    message.utime = kWall + ns / 1000 - latency_us;
    const auto data = bus::wire::encoded(message);
    table_.take(
        {source_, kWall + ns / 1000, ns, channel_, data.data(), static_cast<int>(data.size())});
  }

 private:
  ChannelTable& table_;
  int source_;
  std::string channel_;
};

TEST(ChannelTable, ShowsRateJitterLatencyAndBandwidth) {
  ChannelTable table;
  Feed feed(table);
  // Alternately 9 and 11 ms.
  std::int64_t ns = 0;
  for (int i = 0; i < 400; ++i) {
    feed.take(i, ns, 1500);
    ns += i % 2 == 0 ? 9 * kMs : 11 * kMs;
  }
  const std::vector<ChannelRow> rows = table.rows(ns);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].type, "ft_wrench_t");
  EXPECT_NEAR(rows[0].rate, 100, 0.5);
  EXPECT_NEAR(rows[0].jitter_ms, 1, 0.01);
  EXPECT_NEAR(rows[0].longest_ms, 11, 1e-6);
  EXPECT_NEAR(rows[0].age, 0.011, 1e-9);
  ASSERT_TRUE(rows[0].has_latency);
  EXPECT_NEAR(rows[0].latency_ms, 1.5, 1e-6);
  EXPECT_NEAR(rows[0].bandwidth, 100 * ft_wrench_t{}.getEncodedSize(), 50);
  EXPECT_EQ(rows[0].messages, 400);
  EXPECT_EQ(rows[0].lost, 0);
}

TEST(ChannelTable, OneThatStopsHasNoRateAndGrowsOld) {
  ChannelTable table;
  Feed feed(table);
  for (int i = 0; i < 100; ++i) feed.take(i, i * 10 * kMs);
  EXPECT_GT(table.rows(1000 * kMs)[0].rate, 90);
  const ChannelRow row = table.rows(5990 * kMs)[0];
  EXPECT_EQ(row.rate, 0);
  EXPECT_EQ(row.bandwidth, 0);
  EXPECT_NEAR(row.age, 5, 1e-9);
}

TEST(ChannelTable, SlowOnesKeepTheirRate) {
  ChannelTable table;
  Feed feed(table);
  for (int i = 0; i < 8; ++i) feed.take(i, i * 5000 * kMs);
  EXPECT_NEAR(table.rows((7 * 5000 + 4000) * kMs)[0].rate, 0.2, 1e-9);
}

TEST(ChannelTable, CountsLossesAndSenders) {
  ChannelTable table;
  Feed feed(table);
  for (const int seq : {1, 2, 5, 6, 9}) feed.take(seq, seq * kMs);
  EXPECT_EQ(table.rows(10 * kMs)[0].lost, 4);
  EXPECT_EQ(table.rows(10 * kMs)[0].senders, 1);
}

TEST(ChannelTable, UnknownAndBrokenMessagesAreReported) {
  ChannelTable table;
  const std::vector<std::uint8_t> unknown(40, 1);
  table.take({0, kWall, kMs, "OTHER", unknown.data(), 40});
  auto broken = bus::wire::encoded(ft_wrench_t{});
  broken.pop_back();
  table.take({0, kWall, kMs, "BROKEN", broken.data(), static_cast<int>(broken.size())});
  table.take({0, kWall, kMs, "EMPTY", broken.data(), 0});
  const std::vector<ChannelRow> rows = table.rows(2 * kMs);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].channel, "BROKEN");
  EXPECT_EQ(rows[0].misfits, 1);
  EXPECT_EQ(rows[2].channel, "OTHER");
  EXPECT_EQ(rows[2].misfits, 0);
  EXPECT_EQ(rows[2].type, "");
  EXPECT_LT(rows[2].jitter_ms, 0) << "one message has no jitter";
}

TEST(ChannelTable, AnotherClockHasNoLatency) {
  ChannelTable table;
  Feed feed(table);
  feed.take(1, kMs, 20'000'000);
  feed.take(2, 2 * kMs, std::numeric_limits<std::int64_t>::min() / 2);
  EXPECT_FALSE(table.rows(3 * kMs)[0].has_latency);
}

TEST(ChannelTable, SortsByTheRequestedColumn) {
  ChannelTable table;
  Feed slow(table, 0, "A"), fast(table, 0, "B"), losing(table, 1, "C");
  for (int i = 0; i < 10; ++i) slow.take(i, i * 100 * kMs);
  for (int i = 0; i < 100; ++i) fast.take(i, i * 9 * kMs);
  for (int i = 0; i < 20; ++i) losing.take(3 * i, i * 45 * kMs);
  const auto first = [&](Order order) { return table.rows(1000 * kMs, order)[0].channel; };
  EXPECT_EQ(first(Order::kName), "A");
  EXPECT_EQ(first(Order::kRate), "B");
  EXPECT_EQ(first(Order::kLost), "C");
  EXPECT_EQ(next(Order::kName), Order::kRate);
  EXPECT_EQ(next(Order::kAge), Order::kName);
}

TEST(ChannelTable, NamesDrawnAtRandomFillNoMemory) {
  ChannelTable table;
  for (int i = 0; i < 5000; ++i) Feed(table, 0, "N" + std::to_string(i)).take(1, i * kMs);
  EXPECT_LE(table.rows(5000 * kMs).size(), 1025u);
}

}  // namespace
}  // namespace palpate::top
