#include "tools/lab/fit_check/coverage.hpp"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace palpate::fit_check {
namespace {

// Of 16 correct 95 % intervals, fewer than 12 contain the truth once in a thousand such tests.
TEST(Coverage, IntervalsHoldTheTruthOfOwnModels) {
  const support::ScratchFolder folder;
  for (const OwnModel& model : own_models(folder.path().string())) {
    const std::vector<Coverage> rows = measure_coverage(model.mechanics, model.truth, 16);
    ASSERT_EQ(rows.size(), 2u) << model.mechanics->name();
    for (const Coverage& row : rows) {
      EXPECT_EQ(row.seeds, 16) << row.experiment << " " << row.parameter;
      EXPECT_GE(row.covered, 12) << row.experiment << " " << row.parameter;
      EXPECT_GT(row.mean_width, 0);
      EXPECT_LT(row.mean_width, 1);
    }
  }
}

}  // namespace
}  // namespace palpate::fit_check
