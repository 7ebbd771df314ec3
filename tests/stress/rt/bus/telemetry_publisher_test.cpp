#include "rt/bus/telemetry_publisher.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/stress/rhythm.hpp"

namespace palpate::bus {
namespace {

constexpr int kMessages = 100000;

TEST(TelemetryPublisherStress, MessagesComeWholeAndInOrder) {
  std::int64_t taken = 0, faults = 0, lost = 0;
  {
    stress::Rhythm publishers(4);
    std::int64_t last = -1;
    TelemetryPublisher publisher(
        [&](const char* channel, const void* data, int size) {
          publishers.beat();
          std::int64_t number = 0;
          std::memcpy(&number, data, sizeof(number));
          const auto* bytes = static_cast<const std::uint8_t*>(data);
          const auto filling = static_cast<std::uint8_t>(number % 251);
          faults += number > last ? 0 : 1;
          faults += size == 8 + filling ? 0 : 1;
          faults += std::strcmp(channel, number % 2 == 0 ? "EVEN" : "ODD") == 0 ? 0 : 1;
          for (int i = 8; i < size; ++i) faults += bytes[i] == filling ? 0 : 1;
          last = number;
          ++taken;
          return true;
        },
        4, 264);
    stress::Rhythm rhythm(3);
    for (std::int64_t number = 0; number < kMessages; ++number) {
      rhythm.beat();
      const auto filling = static_cast<std::uint8_t>(number % 251);
      const int size = 8 + filling;
      std::uint8_t* to = publisher.buffer(size);
      std::memcpy(to, &number, sizeof(number));
      std::memset(to + 8, filling, filling);
      ASSERT_TRUE(publisher.commit(number % 2 == 0 ? "EVEN" : "ODD", size));
    }
    lost = publisher.lost();  // the queue still holds at most four, which the destructor sends
  }
  EXPECT_EQ(taken + lost, kMessages);
  EXPECT_EQ(faults, 0);
  EXPECT_GT(taken, 0);
}

}  // namespace
}  // namespace palpate::bus
