#include "tools/lab/endurance/latency.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

namespace palpate::endurance {
namespace {

TEST(Latency, ReadsWhatCyclictestWrites) {
  std::istringstream text(
      "# /dev/cpu_dma_latency set to 0us\n"
      "# Histogram\n"
      "000000 000000\n000010 000060\n000020 000030\n000999 000006\n001000 000002\n"
      "# Total: 000000098\n# Min Latencies: 00010\n# Avg Latencies: 00100\n"
      "# Max Latencies: 07000\n# Histogram Overflows: 00002\n"
      "# Histogram Overflow at cycle number:\n# Thread 0: 00005 00007\n");
  const LatencyTail tail = read_cyclictest(text, 1000);
  EXPECT_EQ(tail.count, 100);
  EXPECT_EQ(tail.max, 7000);
  EXPECT_DOUBLE_EQ(tail.missed, 0.04);
  EXPECT_EQ(tail.at(0.5), 10);
  EXPECT_EQ(tail.at(0.1), 20);
  EXPECT_EQ(tail.at(0.04), 999);
  EXPECT_EQ(tail.at(0.001), 7000);
}

TEST(Latency, RefusesAnEmptyHistogram) {
  std::istringstream text("# Histogram\n000000 000000\n");
  EXPECT_THROW(read_cyclictest(text, 1000), std::runtime_error);
}

}  // namespace
}  // namespace palpate::endurance
