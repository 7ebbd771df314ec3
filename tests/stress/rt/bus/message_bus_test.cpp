#include <gtest/gtest.h>

#include <atomic>
#include <cstring>

#include "rt/bus/message_bus.hpp"
#include "tests/stress/rhythm.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

constexpr std::int64_t kFingerprint = 0x0102030405060708;
constexpr int kSize = 8 + 120, kMessages = 100000;

std::vector<std::uint8_t> message(std::uint8_t number) {
  std::vector<std::uint8_t> bytes(kSize, number);
  for (int i = 0; i < 8; ++i) bytes[i] = static_cast<std::uint8_t>(i + 1);
  return bytes;
}

TEST(SubscriptionStress, MessagesComeWholeWhateverTheReceiverOffers) {
  for (const int depth : {1, 8}) {
    Subscription queue("A", kSize, kFingerprint, depth);
    std::atomic<bool> done{false};
    std::int64_t taken = 0, faults = 0;
    std::thread consumer([&] {
      stress::Rhythm rhythm(2);
      std::vector<std::uint8_t> bytes(kSize);
      std::int64_t arrival = 0, last = -1;
      for (bool finished = false;;) {
        rhythm.beat();
        if (!wire::take(queue, bytes.data(), arrival)) {
          if (finished) return;
          finished = done;
          continue;
        }
        faults += arrival > last ? 0 : 1;
        last = arrival;
        faults += bytes == message(static_cast<std::uint8_t>(arrival)) ? 0 : 1;
        // The counters may be read concurrently.
        faults += queue.counters().received > 0 ? 0 : 1;
        ++taken;
      }
    });
    stress::Rhythm rhythm(1);
    for (int i = 0; i < kMessages; ++i) {
      rhythm.beat();
      std::vector<std::uint8_t> bytes = message(static_cast<std::uint8_t>(i));
      if (i % 10 == 0) queue.offer(bytes.data(), kSize - 1, i);
      queue.offer(bytes.data(), kSize, i);
      bytes[3] ^= 1;
      if (i % 10 == 5) queue.offer(bytes.data(), kSize, i);
    }
    done = true;
    consumer.join();
    const SubscriptionCounters& count = queue.counters();
    EXPECT_EQ(count.received, kMessages);
    EXPECT_EQ(count.wrong_size, kMessages / 10);
    EXPECT_EQ(count.wrong_type, kMessages / 10);
    EXPECT_EQ(taken + count.dropped, kMessages);
    EXPECT_EQ(faults, 0) << "depth " << depth;
  }
}

}  // namespace
}  // namespace palpate::bus
