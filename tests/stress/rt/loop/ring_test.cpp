// Plain memory exchanged between threads: the thread sanitizer detects simultaneous access.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstring>

#include "rt/loop/handover_ring.hpp"
#include "rt/loop/telemetry_queue.hpp"
#include "tests/stress/rhythm.hpp"

namespace palpate::loop {
namespace {

constexpr int kMessages = 100000;
using Wide = std::array<std::int64_t, 32>;

TEST(HandoverRingStress, SlotsAreOwnedByOneThreadAtATime) {
  for (const int depth : {1, 2, 3, 16}) {
    HandoverRing<Wide> ring(depth, Wide{});
    std::atomic<bool> done{false};
    std::int64_t taken = 0, torn = 0, disorder = 0, dropped = 0;
    std::thread consumer([&] {
      stress::Rhythm rhythm(2);
      std::int64_t last = 0;
      for (bool finished = false;;) {
        rhythm.beat();
        Wide* slot = ring.take();
        if (slot == nullptr) {
          if (finished) return;
          finished = done;
          continue;
        }
        const std::int64_t number = slot->front();
        for (std::int64_t& word : *slot) {
          torn += word == number ? 0 : 1;
          word = -1;  // the consumer may write to the slot it owns
        }
        disorder += number > last ? 0 : 1;
        last = number;
        ++taken;
      }
    });
    stress::Rhythm rhythm(1);
    for (int i = 1; i <= kMessages; ++i) {
      rhythm.beat();
      ring.back().fill(i);
      dropped += ring.publish() ? 1 : 0;
    }
    done = true;
    consumer.join();
    EXPECT_EQ(taken + dropped, kMessages) << "depth " << depth;
    EXPECT_EQ(torn + disorder, 0) << "depth " << depth;
    EXPECT_GT(taken, 0);
  }
}

TEST(TelemetryQueueStress, RecordsComeWholeAndInOrder) {
  TelemetryQueue queue(4, 256);
  std::atomic<bool> done{false};
  std::int64_t taken = 0, faults = 0;
  std::thread publisher([&] {
    stress::Rhythm rhythm(4);
    std::uint8_t last = 0;
    for (bool finished = false;;) {
      rhythm.beat();
      const TelemetryQueue::Record* record = queue.take();
      if (record == nullptr) {
        if (finished) return;
        finished = done;
        continue;
      }
      const std::uint8_t number = record->data[0];
      faults += record->size == 1 + number ? 0 : 1;
      faults += std::strcmp(record->channel, number % 2 == 0 ? "EVEN" : "ODD") == 0 ? 0 : 1;
      for (int i = 0; i < record->size; ++i) faults += record->data[i] == number ? 0 : 1;
      faults += taken > 0 && number == last && queue.dropped() == 0 ? 1 : 0;
      last = number;
      ++taken;
    }
  });
  stress::Rhythm rhythm(3);
  for (int i = 0; i < kMessages; ++i) {
    rhythm.beat();
    const auto number = static_cast<std::uint8_t>(i % 255);
    std::memset(queue.buffer(), number, 1 + number);
    ASSERT_TRUE(queue.commit(number % 2 == 0 ? "EVEN" : "ODD", 1 + number));
    EXPECT_EQ(queue.rejected(), 0);
  }
  done = true;
  publisher.join();
  EXPECT_EQ(taken + queue.dropped(), kMessages);
  EXPECT_EQ(faults, 0);
}

}  // namespace
}  // namespace palpate::loop
