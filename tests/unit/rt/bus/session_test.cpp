#include "rt/bus/session.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <palpate/imu_t.hpp>
#include <random>
#include <set>

namespace palpate::bus {
namespace {

constexpr std::int64_t kA = 11;
constexpr std::int64_t kB = 22;

TEST(HeaderStamper, CountsUpByOneWithinASession) {
  HeaderStamper stamp(kA);
  imu_t message{};
  for (int i = 1; i <= 3; ++i) {
    stamp.put(message, 1000 * i);
    EXPECT_EQ(message.utime, 1000 * i);
    EXPECT_EQ(message.seq, i);
    EXPECT_EQ(message.session, kA);
  }
}

TEST(RandomSession, IsPositiveAndDiffersAtEachStart) {
  std::set<std::int64_t> sessions;
  for (int i = 0; i < 1000; ++i) {
    sessions.insert(random_session());
    EXPECT_GT(*sessions.begin(), 0);
  }
  EXPECT_EQ(sessions.size(), 1000u);
}

TEST(SequenceTracker, AcceptsNewerAndRejectsOlderAndDuplicates) {
  SequenceTracker tracker;
  EXPECT_TRUE(tracker.accept(kA, 1));
  EXPECT_TRUE(tracker.accept(kA, 4));
  EXPECT_FALSE(tracker.accept(kA, 2));
  EXPECT_FALSE(tracker.accept(kA, 3));
  EXPECT_FALSE(tracker.accept(kA, 4));
  EXPECT_TRUE(tracker.accept(kA, 5));
  EXPECT_EQ(tracker.lost(), 2);
  EXPECT_EQ(tracker.rejected(), 3);
  EXPECT_EQ(tracker.sessions(), 1);
}

TEST(SequenceTracker, NumbersMayWrap) {
  SequenceTracker tracker;
  constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
  EXPECT_TRUE(tracker.accept(kA, kLargest - 1));
  EXPECT_TRUE(tracker.accept(kA, kLargest));
  EXPECT_TRUE(tracker.accept(kA, std::numeric_limits<std::int32_t>::min()));
  EXPECT_FALSE(tracker.accept(kA, kLargest));
  EXPECT_EQ(tracker.lost(), 0);
}

TEST(SequenceTracker, ARestartIsANewSessionAndTheOldOneIsOver) {
  SequenceTracker tracker;
  EXPECT_TRUE(tracker.accept(kA, 1000));
  EXPECT_TRUE(tracker.accept(kB, 1));
  EXPECT_EQ(tracker.sessions(), 2);
  EXPECT_FALSE(tracker.accept(kA, 1001));  // was still in transit
  EXPECT_TRUE(tracker.accept(kB, 2));
  EXPECT_EQ(tracker.lost(), 0);
  EXPECT_EQ(tracker.rejected(), 1);
}

TEST(SequenceTracker, RemembersSeveralSessionsThatWereLeft) {
  SequenceTracker tracker;
  for (std::int64_t session = 1; session <= 5; ++session) EXPECT_TRUE(tracker.accept(session, 100));
  for (std::int64_t session = 1; session <= 4; ++session)
    EXPECT_FALSE(tracker.accept(session, 101)) << session;
  EXPECT_TRUE(tracker.accept(5, 101));
  EXPECT_EQ(tracker.sessions(), 5);
}

TEST(SequenceTracker, ALogPlayedAgainIsBelievedAfterTwentyMessages) {
  SequenceTracker tracker;
  for (int seq = 1; seq <= 500; ++seq) ASSERT_TRUE(tracker.accept(kA, seq));
  for (int seq = 1; seq <= 19; ++seq) ASSERT_FALSE(tracker.accept(kA, seq)) << seq;
  for (int seq = 20; seq <= 500; ++seq) ASSERT_TRUE(tracker.accept(kA, seq)) << seq;
  EXPECT_EQ(tracker.sessions(), 2);
  EXPECT_EQ(tracker.rejected(), 19);
  EXPECT_EQ(tracker.lost(), 0);
}

TEST(SequenceTracker, AnOldSessionPlayedAgainIsBelievedAfterTwentyMessages) {
  SequenceTracker tracker;
  ASSERT_TRUE(tracker.accept(kA, 1));
  ASSERT_TRUE(tracker.accept(kB, 1));
  int accepted = 0;
  for (int seq = 1; seq <= 100; ++seq) accepted += tracker.accept(kA, seq) ? 1 : 0;
  EXPECT_EQ(accepted, 81);
  EXPECT_FALSE(tracker.accept(kB, 2));
}

TEST(SequenceTracker, RepeatedDuplicatesNeverRestartASession) {
  SequenceTracker tracker;
  for (int seq = 1; seq <= 50; ++seq) {
    ASSERT_TRUE(tracker.accept(kA, seq));
    for (int copy = 0; copy < 100; ++copy) ASSERT_FALSE(tracker.accept(kA, seq));
    for (int copy = 0; copy < 100; ++copy) ASSERT_FALSE(tracker.accept(kA, seq - 1));
  }
  EXPECT_EQ(tracker.sessions(), 1);
  EXPECT_EQ(tracker.lost(), 0);
}

TEST(SequenceTracker, OfTwoSendersTheNewerSessionWins) {
  SequenceTracker tracker;
  ASSERT_TRUE(tracker.accept(kA, 500));
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_TRUE(tracker.accept(kB, i));
    ASSERT_FALSE(tracker.accept(kA, 500 + i));
  }
  EXPECT_EQ(tracker.sessions(), 2);
}

TEST(SequenceTracker, AcceptedNumbersRiseAndAddUpUnderLossReorderingAndDuplicates) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    std::vector<int> sent;
    for (int seq = 1; seq <= 2000; ++seq) {
      const double fate = std::uniform_real_distribution<double>()(random);
      if (fate < 0.1 && seq > 1) continue;
      sent.push_back(seq);
      if (fate > 0.9) sent.push_back(seq);
    }
    // Each may move back by up to 16 places.
    for (std::size_t i = 1; i + 17 < sent.size(); i += 17)
      std::shuffle(sent.begin() + static_cast<std::ptrdiff_t>(i),
                   sent.begin() + static_cast<std::ptrdiff_t>(i + 17), random);
    SequenceTracker tracker;
    int last = 0;
    std::int64_t accepted = 0;
    for (const int seq : sent) {
      if (!tracker.accept(kA, seq)) continue;
      ASSERT_GT(seq, last) << "seed " << seed;
      last = seq;
      ++accepted;
    }
    ASSERT_EQ(accepted + tracker.lost(), last) << "seed " << seed;
    ASSERT_EQ(accepted + tracker.rejected(), static_cast<std::int64_t>(sent.size()));
    ASSERT_EQ(tracker.sessions(), 1);
  }
}

}  // namespace
}  // namespace palpate::bus
