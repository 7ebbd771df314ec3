#include <gtest/gtest.h>

#include <limits>

#include "tools/record/message_types.hpp"

namespace palpate::record {
namespace {

void take(SequenceGaps& gaps, std::int64_t session, std::initializer_list<std::int32_t> numbers) {
  for (const std::int32_t seq : numbers) gaps.take({0, seq, session});
}

TEST(SequenceGaps, CountsWhatIsMissingAndTakesOffWhatComesLate) {
  SequenceGaps gaps;
  take(gaps, 1, {10, 11, 12, 15});
  EXPECT_EQ(gaps.lost(), 2);
  take(gaps, 1, {13});
  EXPECT_EQ(gaps.lost(), 1);
  take(gaps, 1, {16, 16, 17});
  EXPECT_EQ(gaps.lost(), 1) << "the same once more is no loss";
}

TEST(SequenceGaps, SendersDoNotDisturbEachOther) {
  SequenceGaps gaps;
  for (std::int32_t i = 0; i < 100; ++i) {
    take(gaps, 1, {1000 + i});
    take(gaps, 2, {5 + i});
  }
  EXPECT_EQ(gaps.lost(), 0);
  EXPECT_EQ(gaps.sessions(), 2);
}

TEST(SequenceGaps, NumbersWrap) {
  SequenceGaps gaps;
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  take(gaps, 1, {kMost - 1, kMost, kLeast, kLeast + 2});
  EXPECT_EQ(gaps.lost(), 1);
}

TEST(SequenceGaps, ALogThatIsPlayedOnceMoreIsNoLoss) {
  SequenceGaps gaps;
  take(gaps, 1, {5'000'000, 5'000'001});
  take(gaps, 1, {1, 2, 3});
  EXPECT_EQ(gaps.lost(), 0);
}

TEST(SequenceGaps, SessionsDrawnAtRandomFillNoMemory) {
  SequenceGaps gaps;
  for (std::int64_t session = 0; session < 100'000; ++session) take(gaps, session, {1});
  EXPECT_LE(gaps.sessions(), 64);
}

}  // namespace
}  // namespace palpate::record
