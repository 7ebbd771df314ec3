// Each row of the table of faults once in real processes; palpate-evaluate faults --process runs
// any number of seeds, with the times.

#include <gtest/gtest.h>

#include <cmath>

#include "tools/lab/faults/campaign.hpp"
#include "tools/lab/faults/faults_process.hpp"

namespace palpate::evaluate {
namespace {

/// Tolerance of timing bounds on a busy machine.
constexpr double kGenerous = 5;

class ProcessFaultTable : public testing::TestWithParam<int> {};

TEST_P(ProcessFaultTable, RowIsSurvivedAndReported) {
  const faults::Row row = faults::process_rows()[GetParam()];
  const faults::RowReport report = faults::run_row(faults::make_bench(), row, 1, 1);
  std::printf("%s %s: %s; seen %.1f ms, reported %.1f ms, back %.1f ms, %g %s (limit %g)\n",
              row.number.c_str(), row.fault.c_str(), name(report.worst()), 1e3 * report.detected,
              1e3 * report.visible, 1e3 * report.recovered, report.measured, row.unit.c_str(),
              row.limit);
  if (report.miss.find(faults::kNotPlayed) != std::string::npos) GTEST_SKIP() << report.miss;
  EXPECT_EQ(report.survived(), report.seeds) << report.miss;
  EXPECT_EQ(report.crashes, 0);
  EXPECT_LE(report.measured, kGenerous * row.limit) << report.miss;
}

std::string name_of(const testing::TestParamInfo<int>& info) {
  const faults::Row row = faults::process_rows()[info.param];
  std::string text = "Row" + row.number + "_" + std::to_string(info.param) + "_";
  for (const char c : row.fault) text += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return text;
}

INSTANTIATE_TEST_SUITE_P(Rows, ProcessFaultTable,
                         testing::Range(0, static_cast<int>(faults::process_rows().size())),
                         name_of);

}  // namespace
}  // namespace palpate::evaluate
