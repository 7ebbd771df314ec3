#include <gtest/gtest.h>

#include <cstdlib>

#include "tools/lab/faults/campaign.hpp"
#include "tools/lab/faults/rows.hpp"

namespace palpate::faults {
namespace {

/// Few enough that each row takes seconds; set PALPATE_FAULT_SEEDS for more.
int seeds() {
  const char* text = std::getenv("PALPATE_FAULT_SEEDS");
  return text == nullptr ? 20 : std::atoi(text);
}

class FaultTable : public testing::TestWithParam<int> {
 protected:
  static const Bench& bench() {
    static const Bench kBench = make_bench();
    return kBench;
  }
};

TEST_P(FaultTable, RowIsSurvivedAndItsFigureMet) {
  const Row row = all_rows()[GetParam()];
  const RowReport report = run_row(bench(), row, seeds(), 2);
  std::printf("%s %s: %s; seen %.1f ms, reported %.1f ms, back %.1f ms, %g %s (limit %g)\n",
              row.number.c_str(), row.fault.c_str(), name(report.worst()), 1e3 * report.detected,
              1e3 * report.visible, 1e3 * report.recovered, report.measured, row.unit.c_str(),
              row.limit);
  EXPECT_EQ(report.survived(), report.seeds) << report.miss;
  EXPECT_EQ(report.crashes, 0);
  EXPECT_TRUE(report.met()) << report.measured << ' ' << row.unit << "; " << report.below_figure
                            << " seeds; " << report.miss;
}

std::string name_of(const testing::TestParamInfo<int>& info) {
  const Row row = all_rows()[info.param];
  std::string text = "Row" + row.number + "_" + std::to_string(info.param) + "_";
  for (const char c : row.fault) text += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return text;
}

INSTANTIATE_TEST_SUITE_P(Rows, FaultTable, testing::Range(0, static_cast<int>(all_rows().size())),
                         name_of);

}  // namespace
}  // namespace palpate::faults
