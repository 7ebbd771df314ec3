#include "tools/log/sequence.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace palpate::log {
namespace {

Sequence of(const std::vector<int>& numbers) {
  Sequence sequence;
  for (const int number : numbers) sequence.add(number);
  return sequence;
}

TEST(Sequence, CountsWhatIsMissingLateAndTwice) {
  const Sequence whole = of({5, 6, 7, 8});
  EXPECT_EQ(whole.lost(), 0);
  EXPECT_EQ(whole.late(), 0);
  const Sequence gaps = of({1, 2, 5, 6, 10});
  EXPECT_EQ(gaps.lost(), 5);
  const Sequence mixed = of({1, 3, 2, 3, 4, 4, 6});
  EXPECT_EQ(mixed.lost(), 1);  // 5
  EXPECT_EQ(mixed.late(), 1);
  EXPECT_EQ(mixed.repeated(), 2);
  EXPECT_EQ(mixed.received(), 7);
}

TEST(Sequence, WhatComesBeforeTheFirstOneBelongsToIt) {
  const Sequence sequence = of({3, 1, 4});
  EXPECT_EQ(sequence.late(), 1);
  EXPECT_EQ(sequence.lost(), 1);  // 2
}

TEST(Sequence, GapsLargerThanItsMemoryAreCountedToo) {
  const Sequence sequence = of({1, 100'000, 100'002, 100'001});
  EXPECT_EQ(sequence.lost(), 99'998);
  EXPECT_EQ(sequence.late(), 1);
  EXPECT_EQ(Sequence().lost(), 0);
}

}  // namespace
}  // namespace palpate::log
