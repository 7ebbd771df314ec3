#include "tools/recordings/recording_table.hpp"

#include <algorithm>
#include <cmath>

#include <stdexcept>

#include "tools/recordings/csv_reader.hpp"
#include "tools/recordings/log_table.hpp"

namespace palpate::recordings {

std::vector<Table> read_tables(const std::string& path, const std::string& time,
                               const std::vector<std::string>& columns,
                               const std::string& separator) {
  if (is_log(path)) {
    if (!separator.empty())
      throw std::runtime_error(path + ": a log has no column '" + separator +
                               "' that separates recordings");
    return read_log_tables(path, time, columns);
  }
  recordings::CsvReader csv(path);
  const int time_column = csv.column(time);
  const int separator_column = separator.empty() ? -1 : csv.column(separator);
  std::vector<int> indices;
  for (const std::string& name : columns) indices.push_back(csv.column(name));

  std::vector<Table> tables;
  std::string label;
  std::vector<double> times;
  std::vector<double> cells;
  const auto finish = [&] {
    if (times.size() < 2) csv.fail("a recording of fewer than two rows ends here");
    using Rows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
    Table table;
    table.name = path.substr(path.find_last_of('/') + 1) + (separator.empty() ? "" : ":" + label);
    table.time = Eigen::Map<Eigen::VectorXd>(times.data(), static_cast<Eigen::Index>(times.size()));
    table.time.array() -= times.front();
    table.rows = Rows(cells.data(), static_cast<Eigen::Index>(times.size()),
                      static_cast<Eigen::Index>(indices.size()));
    tables.push_back(std::move(table));
    times.clear();
    cells.clear();
  };
  while (csv.next()) {
    if (separator_column >= 0 && csv.text(separator_column) != label) {
      if (!times.empty()) finish();
      label = csv.text(separator_column);
    }
    const double t = csv.number(time_column);
    if (!times.empty() && t <= times.back()) {
      if (t < times.back()) csv.fail(time_column, "time runs backwards");
      continue;  // the same time twice: the first counts
    }
    times.push_back(t);
    for (const int index : indices) cells.push_back(csv.number(index));
  }
  finish();
  return tables;
}

Table resample(const Table& table, double rate, double average) {
  const Eigen::Index n = table.time.size();
  const double tolerance = 1e-6;  // s, tolerance for times written with a few decimals
  const auto count =
      static_cast<Eigen::Index>(std::floor((table.time[n - 1] + tolerance) * rate)) + 1;
  Table result;
  result.name = table.name;
  result.time.resize(count);
  result.rows.resize(count, table.rows.cols());
  Eigen::Index begin = 0, end = 0;  // samples of the window
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / rate;
    result.time[k] = t;
    while (end < n && table.time[end] <= t + tolerance) ++end;
    while (begin < end - 1 && table.time[begin] <= t - average + tolerance) ++begin;
    if (average <= 0) begin = end - 1;
    result.rows.row(k) = table.rows.middleRows(begin, end - begin).colwise().mean();
  }
  return result;
}

void delay_columns(Table& table, int first, int count, double seconds) {
  const Eigen::Index n = table.time.size();
  const double step = table.time[n - 1] / static_cast<double>(n - 1);
  const Eigen::MatrixXd before = table.rows.middleCols(first, count);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double at =
        std::clamp(static_cast<double>(k) - seconds / step, 0.0, static_cast<double>(n - 1));
    const auto left = std::min(static_cast<Eigen::Index>(at), n - 2);
    const double part = at - static_cast<double>(left);
    table.rows.row(k).segment(first, count) =
        (1 - part) * before.row(left) + part * before.row(left + 1);
  }
}

}  // namespace palpate::recordings
