// Plain memory exchanged between threads: the thread sanitizer detects simultaneous access.

#include <gtest/gtest.h>

#include <array>
#include <atomic>

#include "rt/loop/handover_ring.hpp"
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

}  // namespace
}  // namespace palpate::loop
