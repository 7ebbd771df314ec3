#include "rt/loop/telemetry_queue.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <thread>

#include "rt/loop/allocation_counter.hpp"

namespace palpate::loop {
namespace {

void push(TelemetryQueue& queue, const char* channel, const std::string& text) {
  std::memcpy(queue.buffer(), text.data(), text.size());
  ASSERT_TRUE(queue.commit(channel, static_cast<int>(text.size())));
}

std::string text_of(const TelemetryQueue::Record& record) {
  return {record.data.begin(), record.data.begin() + record.size};
}

TEST(TelemetryQueue, CarriesRecordsOfAnySizeWithTheirChannel) {
  TelemetryQueue queue(4, 100);
  push(queue, "SHAPE", std::string(100, 'x'));
  push(queue, "HEALTH", "");
  push(queue, std::string(63, 'C').c_str(), "short");
  EXPECT_EQ(text_of(*queue.take()), std::string(100, 'x'));
  const TelemetryQueue::Record* empty = queue.take();
  EXPECT_STREQ(empty->channel, "HEALTH");
  EXPECT_EQ(empty->size, 0);
  const TelemetryQueue::Record* last = queue.take();
  EXPECT_EQ(last->channel, std::string(63, 'C'));
  EXPECT_EQ(text_of(*last), "short");
  EXPECT_EQ(queue.take(), nullptr);
}

TEST(TelemetryQueue, CountsWhatItDropsAndRefuses) {
  TelemetryQueue queue(2, 10);
  for (const char* text : {"1", "2", "3", "4", "5"}) push(queue, "A", text);
  EXPECT_EQ(queue.dropped(), 3);
  EXPECT_EQ(text_of(*queue.take()), "4");
  EXPECT_FALSE(queue.commit("A", 11));
  EXPECT_FALSE(queue.commit("A", -1));
  EXPECT_FALSE(queue.commit("", 1));
  EXPECT_FALSE(queue.commit(std::string(64, 'C'), 1));
  EXPECT_EQ(queue.rejected(), 4);
  EXPECT_EQ(text_of(*queue.take()), "5");
  EXPECT_EQ(queue.take(), nullptr);
}

TEST(TelemetryQueue, AllocatesNothingAfterConstruction) {
  TelemetryQueue queue(3, 50'000);
  const NoAllocationScope scope;
  for (int i = 0; i < 100; ++i) {
    queue.commit("SHAPE", 50'000 - i);
    if (i % 2 == 0) queue.take();
  }
  EXPECT_EQ(scope.count(), 0);
}

TEST(TelemetryQueue, RefusesARecordSizeThatIsNotPositive) {
  EXPECT_THROW(TelemetryQueue(2, 0), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::loop
