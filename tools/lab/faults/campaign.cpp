#include "tools/lab/faults/campaign.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/lab/faults/isolated.hpp"
#include "tools/lab/faults/rows.hpp"

namespace palpate::faults {

Outcome RowReport::worst() const {
  int worst = kOutcomes - 1;
  while (worst > 0 && outcomes[worst] == 0) --worst;
  return static_cast<Outcome>(worst);
}

bool RowReport::met() const {
  return survived() == seeds && measured <= row.limit && below_figure == 0;
}

RowReport summarise(const Row& row, const std::vector<RunResult>& results) {
  RowReport report;
  report.row = row;
  report.seeds = static_cast<int>(results.size());
  double sum = 0;
  for (const RunResult& result : results) {
    ++report.outcomes[static_cast<int>(result.outcome)];
    report.crashes += result.crashed ? 1 : 0;
    report.detected = std::max(report.detected, result.detected);
    report.visible = std::max(report.visible, result.visible);
    report.recovered = std::max(report.recovered, result.recovered);
    report.measured = std::max(report.measured, result.measured);
    sum += result.measured;
    const bool missed =
        result.has_miss() || (!row.mean && std::isfinite(row.limit) && result.measured > row.limit);
    if (!missed) continue;
    if (report.below_figure++ > 0) continue;
    report.miss =
        "seed " + std::to_string(result.seed) + ": " +
        (result.has_miss() ? result.miss.data() : std::to_string(result.measured) + " " + row.unit);
  }
  if (row.mean && report.seeds > 0) report.measured = sum / report.seeds;
  return report;
}

double wilson_lower(int good, int count) {
  constexpr double kZ = 1.959963984540054;
  if (count == 0) return 0;
  const double n = count, p = good / n, z2 = kZ * kZ;
  return (p + z2 / (2 * n) - kZ * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n))) / (1 + z2 / n);
}

std::vector<Row> choose_rows(const std::vector<std::string>& numbers) {
  return choose_rows(all_rows(), numbers);
}

std::vector<Row> choose_rows(const std::vector<Row>& all, const std::vector<std::string>& numbers) {
  if (numbers.empty()) return all;
  std::vector<Row> chosen;
  for (const std::string& number : numbers) {
    const std::size_t before = chosen.size();
    for (const Row& row : all)
      if (row.number == number) chosen.push_back(row);
    if (chosen.size() == before)
      throw std::invalid_argument("row " + number + " is not among these");
  }
  return chosen;
}

RowReport run_row(const Bench& bench, const Row& row, int seeds, int jobs,
                  const std::function<void(int)>& done, std::uint64_t first_seed) {
  std::vector<RunResult> results = run_isolated(
      seeds, jobs, [&](int i) { return row.run(bench, first_seed + i); }, done);
  for (int i = 0; i < seeds; ++i) results[i].seed = first_seed + i;
  return summarise(row, results);
}

}  // namespace palpate::faults
