#include "core/contact/approach_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::contact {
namespace {

TEST(ApproachRecord, AveragesOverStepsOfTravel) {
  ApproachRecord record(1e-3);
  for (int i = 0; i < 100; ++i) record.add(1e-4 * i + 5e-5, i);  // ten samples a step
  ASSERT_EQ(record.count(), 10);
  for (int step = 0; step < 10; ++step) {
    EXPECT_EQ(record[step].samples, 10);
    EXPECT_NEAR(record[step].travel, 1e-3 * (step + 0.5), 1e-12);
    EXPECT_NEAR(record[step].force, 10 * step + 4.5, 1e-9);
  }
}

TEST(ApproachRecord, ATipThatRestsOrGoesBackBelongsToThePresentStep) {
  ApproachRecord record(1e-3);
  record.add(1.5e-3, 1);
  record.add(0.2e-3, 2);
  record.add(1.4e-3, 3);
  ASSERT_EQ(record.count(), 1);
  EXPECT_EQ(record[0].samples, 3);
  EXPECT_NEAR(record[0].force, 2, 1e-12);
}

TEST(ApproachRecord, KeepsTheLatestSteps) {
  ApproachRecord record(1e-3);
  const int more = ApproachRecord::kMostSteps + 100;
  for (int i = 0; i < more; ++i) record.add(1e-3 * (i + 0.5), i);
  EXPECT_EQ(record.count(), ApproachRecord::kMostSteps);
  EXPECT_EQ(record[0].force, 100);
  EXPECT_EQ(record[record.count() - 1].force, more - 1);
  record.clear();
  EXPECT_EQ(record.count(), 0);
  record.add(-5e-3, 7);  // before the last one: a new approach
  EXPECT_EQ(record[0].force, 7);
}

TEST(ApproachRecord, LeavesOutWhatIsNotFinite) {
  ApproachRecord record(1e-3);
  record.add(std::nan(""), 1);
  record.add(0, std::numeric_limits<double>::infinity());
  EXPECT_EQ(record.count(), 0);
  EXPECT_THROW(ApproachRecord(0), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::contact
