#include "core/factor/supernodes.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpate::factor {
namespace {

struct Run {
  int begin, end;
  std::vector<int> rows;
};

/// Cost of a panel in a solve, in scalars read: its entries, gather and scatter per row, and a
/// constant overhead.
double panel_cost(int columns, std::size_t rows) {
  constexpr double kPanel = 500, kRow = 5;
  const double c = 3.0 * columns, r = 3.0 * static_cast<double>(rows);
  return kPanel + kRow * r + c * (0.5 * c + r + 8);
}

}  // namespace

Supernodes::Supernodes(const BlockPattern& pattern) : pattern_(&pattern) {
  const int n = pattern.interior_size();
  std::vector<std::vector<int>> children(n);
  std::vector<std::vector<int>> below(n);  // rows of each column of the factor
  std::vector<Run> runs;
  for (int k = 0; k < n; ++k) {
    const auto row = pattern.row().begin();
    below[k].assign(row + pattern.column_start()[k] + 1, row + pattern.column_start()[k + 1]);
    for (int child : children[k]) {
      std::vector<int> joined;
      std::set_union(below[k].begin(), below[k].end(), below[child].begin() + 1, below[child].end(),
                     std::back_inserter(joined));
      below[k] = std::move(joined);
    }
    if (!below[k].empty() && below[k][0] < n) children[below[k][0]].push_back(k);

    Run run{k, k + 1, below[k]};
    while (!runs.empty()) {
      const Run& last = runs.back();
      if (last.rows.empty() || last.rows[0] >= run.end) break;
      const double apart = panel_cost(last.end - last.begin, last.rows.size()) +
                           panel_cost(run.end - run.begin, run.rows.size());
      if (panel_cost(run.end - last.begin, run.rows.size()) > apart) break;
      run.begin = last.begin;
      runs.pop_back();
    }
    runs.push_back(std::move(run));
  }

  std::vector<int> holder(n);
  for (const Run& run : runs) {
    std::fill(holder.begin() + run.begin, holder.begin() + run.end, count());
    begin_.push_back(run.end);
    rows_.insert(rows_.end(), run.rows.begin(), run.rows.end());
    row_start_.push_back(static_cast<int>(rows_.size()));
  }
  for (const Run& run : runs) {
    const bool inside = !run.rows.empty() && run.rows[0] < n;
    parent_.push_back(inside ? holder[run.rows[0]] : count());
  }
}

double Supernodes::cost(int s) const {
  return panel_cost(columns(s), static_cast<std::size_t>(rows(s)));
}

long Supernodes::entries() const {
  long sum = 0;
  for (int s = 0; s < count(); ++s) {
    const long c = 3L * columns(s), r = 3L * rows(s);
    sum += c * (c + 1) / 2 + c * r;
  }
  return sum;
}

}  // namespace palpate::factor
