#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/lab/faults/judge.hpp"

namespace palpate::faults {

/// Outcomes of all seeds of a row.
struct RowReport {
  Row row;
  int seeds = 0;
  std::array<int, kOutcomes> outcomes{};
  int crashes = 0;
  double detected = -1, visible = -1, recovered = -1;  // s, the longest
  double measured = -1;                                // the largest, or the mean
  int below_figure = 0;                                // seeds that missed one of the row's bounds
  std::string miss;                                    // of the first seed that did, with the seed

  int survived() const { return seeds - outcomes[static_cast<int>(Outcome::kFailed)]; }
  Outcome worst() const;
  bool met() const;
};

RowReport summarise(const Row& row, const std::vector<RunResult>& results);

/// Lower bound of Wilson's 95 % confidence interval of a proportion, `good` of `count`.
double wilson_lower(int good, int count);

/// Rows whose numbers are in `numbers` ("1", "12"); all if it is empty. Throws
/// std::invalid_argument for an unknown number.
std::vector<Row> choose_rows(const std::vector<std::string>& numbers);
/// The same for other rows.
std::vector<Row> choose_rows(const std::vector<Row>& all, const std::vector<std::string>& numbers);

/// Runs a row with seeds from `first_seed` on, in `jobs` processes.
RowReport run_row(const Bench& bench, const Row& row, int seeds, int jobs,
                  const std::function<void(int)>& done = {}, std::uint64_t first_seed = 1);

}  // namespace palpate::faults
