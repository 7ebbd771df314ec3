// Transitions of ContactDetector, in the order of the table in its header.
#include "core/estimation/contact_detector.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace palpate::estimation {
namespace {

using State = ContactDetector::State;

constexpr double kRows = 6;
constexpr double kQuiet = 6;          // normalised square of noise alone
constexpr double kSudden = 20;        // above the first threshold, below the second
constexpr double kVerySudden = 30;    // above both
constexpr double kUnexplained = 50;   // above the gate of 40
constexpr double kSignificant = 100;  // of a force
constexpr double kPeriod = 0.01;      // s

class ContactDetectorTest : public ::testing::Test {
 protected:
  void change(double latest, double mean = kQuiet) { detector_.judge_change(latest, mean, kRows); }
  void contact(double test, bool is_below_noise = false, bool is_as_before = false) {
    detector_.judge_contact(test, kRows, is_below_noise, is_as_before);
  }
  bool tick(double significance = kSignificant, bool has_baseline = true) {
    return detector_.advance(kPeriod, significance, has_baseline);
  }
  /// The last contact ended so long ago that it has no more effect.
  void forget_last_contact() {
    for (int i = 0; i < 1000; ++i) tick();
  }

  ContactDetector detector_{WrenchSampling(), ContactDetector::Options()};
};

TEST_F(ContactDetectorTest, NoiseAloneRaisesNoSuspicion) {
  for (int i = 0; i < 10; ++i) change(kQuiet);
  EXPECT_EQ(detector_.state(), State::kNone);
  change(-1, -1);  // not available
  EXPECT_EQ(detector_.state(), State::kNone);
  change(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(detector_.state(), State::kNone);
}

TEST_F(ContactDetectorTest, OneSuddenChangeIsSuspectedAndForgotten) {
  change(kSudden);
  EXPECT_EQ(detector_.state(), State::kSuspected);
  EXPECT_FALSE(detector_.has_contact());
  EXPECT_FALSE(detector_.wants_search());
  change(kQuiet);
  EXPECT_EQ(detector_.state(), State::kNone);
  EXPECT_EQ(detector_.unexplained_count(), 0);
}

TEST_F(ContactDetectorTest, TwoSuddenChangesStartASearchIfTheSecondIsRarer) {
  change(kSudden);
  change(kSudden);
  EXPECT_FALSE(detector_.wants_search());
  change(kQuiet);
  change(kSudden);
  change(kVerySudden);
  EXPECT_EQ(detector_.state(), State::kSuspected);
  EXPECT_TRUE(detector_.wants_search());
}

TEST_F(ContactDetectorTest, LastingChangesStartASearch) {
  change(kQuiet, kUnexplained);
  change(kQuiet, kUnexplained);
  EXPECT_FALSE(detector_.wants_search());
  change(kQuiet, kUnexplained);
  EXPECT_TRUE(detector_.wants_search());
}

TEST_F(ContactDetectorTest, ThresholdsGrowWithTheNumberOfHands) {
  detector_.judge_change(kSudden, kQuiet, 2 * kRows);
  EXPECT_EQ(detector_.state(), State::kNone);
}

TEST_F(ContactDetectorTest, AfterTwoSecondsABaselineIsDue) {
  int updates = 0;
  for (; !detector_.needs_baseline(); ++updates) change(kQuiet, kUnexplained);
  EXPECT_NEAR(updates * kPeriod, 2, 2 * kPeriod);
  EXPECT_TRUE(detector_.is_overdue());
  EXPECT_EQ(detector_.state(), State::kSuspected);
}

TEST_F(ContactDetectorTest, TracksFromTheBeginOnAndDiscardsTheSuspicion) {
  change(kVerySudden);
  change(kVerySudden);
  detector_.begin();
  EXPECT_EQ(detector_.state(), State::kTracking);
  EXPECT_TRUE(detector_.has_contact());
  EXPECT_EQ(detector_.unexplained_count(), 0);
  contact(kQuiet);
  EXPECT_FALSE(tick());
  EXPECT_EQ(detector_.state(), State::kTracking);
}

TEST_F(ContactDetectorTest, AContactThatNoLongerExplainsIsSearchedForElsewhere) {
  detector_.begin();
  contact(kUnexplained);
  EXPECT_EQ(detector_.state(), State::kUnexplained);
  EXPECT_FALSE(detector_.wants_new_location());
  contact(kUnexplained);
  EXPECT_TRUE(detector_.wants_new_location());
  detector_.begin();  // another location
  EXPECT_EQ(detector_.state(), State::kTracking);
  contact(kUnexplained);
  contact(kQuiet);  // the same location explains it again
  EXPECT_EQ(detector_.state(), State::kTracking);
  EXPECT_EQ(detector_.unexplained_count(), 0);
}

TEST_F(ContactDetectorTest, AnUnexplainedContactIsDroppedAfterThreeTenthsOfASecond) {
  detector_.begin();
  int ticks = 1;
  for (contact(kUnexplained); !tick(); ++ticks) contact(kUnexplained);
  EXPECT_NEAR(ticks * kPeriod, 0.3, 2 * kPeriod);
}

TEST_F(ContactDetectorTest, ReleasedOnceTwoUpdatesAreAsBeforeTheContact) {
  detector_.begin();
  contact(kUnexplained, false, true);
  EXPECT_EQ(detector_.state(), State::kUnexplained);
  EXPECT_FALSE(tick());
  contact(kUnexplained, false, true);
  EXPECT_EQ(detector_.state(), State::kReleased);
  EXPECT_FALSE(detector_.wants_new_location());
  EXPECT_TRUE(tick());
  detector_.end();
  EXPECT_EQ(detector_.state(), State::kNone);
}

TEST_F(ContactDetectorTest, AWeakContactIsDroppedAfterThreeTenthsOfASecond) {
  for (const bool is_below_noise : {true, false}) {
    detector_.begin();
    int ticks = 1;
    const double significance = is_below_noise ? kSignificant : 8;  // 3 sigma: 9
    for (contact(kQuiet, is_below_noise); !tick(significance); ++ticks) {
      EXPECT_TRUE(detector_.is_weak());
      contact(kQuiet, is_below_noise);
    }
    EXPECT_NEAR(ticks * kPeriod, 0.3, 2 * kPeriod);
    detector_.end();
  }
}

TEST_F(ContactDetectorTest, ReportedOnceTwoUpdatesConfirmIt) {
  detector_.begin();
  for (int i = 0; i < 10; ++i) contact(kQuiet, true);  // not by a force within the noise
  contact(kUnexplained);                               // nor by one update that it does not explain
  contact(kQuiet);
  EXPECT_FALSE(detector_.is_confirmed());
  contact(kQuiet);
  EXPECT_TRUE(detector_.is_confirmed());
  contact(kUnexplained);
  detector_.begin();  // at another location
  EXPECT_TRUE(detector_.is_confirmed());
  detector_.end();
  detector_.begin();
  EXPECT_FALSE(detector_.is_confirmed());
}

TEST_F(ContactDetectorTest, ReportedIfItExplainsNothingButTheChangeLasts) {
  detector_.begin();
  contact(kUnexplained);
  contact(kUnexplained, false, true);
  EXPECT_FALSE(detector_.is_confirmed());  // released
  detector_.end();
  detector_.begin();
  contact(kUnexplained);
  EXPECT_FALSE(detector_.is_confirmed());
  contact(kUnexplained);
  EXPECT_TRUE(detector_.is_confirmed());
}

TEST_F(ContactDetectorTest, StrengthResetsTheTimeOfWeakness) {
  detector_.begin();
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(tick(0));
  EXPECT_FALSE(tick(kSignificant));
  EXPECT_FALSE(detector_.is_weak());
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(tick(0));
}

TEST_F(ContactDetectorTest, WhileTheForceIsNotEstimatedItsSignificanceDoesNotCount) {
  detector_.begin();
  contact(kUnexplained);
  EXPECT_FALSE(tick(0));
  EXPECT_FALSE(detector_.is_weak());
}

TEST_F(ContactDetectorTest, DroppedWithoutBaseline) {
  detector_.begin();
  EXPECT_TRUE(tick(kSignificant, false));
}

TEST_F(ContactDetectorTest, ThresholdsAreHigherJustAfterAContact) {
  detector_.begin();
  detector_.end();
  change(kUnexplained);
  EXPECT_EQ(detector_.state(), State::kNone);
  forget_last_contact();
  change(kUnexplained);
  EXPECT_EQ(detector_.state(), State::kSuspected);
}

TEST_F(ContactDetectorTest, ClearDiscardsASuspicionButNotAContact) {
  change(kSudden);
  detector_.clear();
  EXPECT_EQ(detector_.state(), State::kNone);
  detector_.begin();
  detector_.clear();
  EXPECT_EQ(detector_.state(), State::kTracking);
}

TEST_F(ContactDetectorTest, ResetReturnsToTheInitialState) {
  detector_.begin();
  detector_.end();
  change(kUnexplained);
  detector_.reset();
  EXPECT_EQ(detector_.state(), State::kNone);
  change(kSudden);  // not wary
  EXPECT_EQ(detector_.state(), State::kSuspected);
}

}  // namespace
}  // namespace palpate::estimation
