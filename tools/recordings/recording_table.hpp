#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::recordings {

/// Some columns of a recording over time.
struct Table {
  std::string name;      // of the recording
  Eigen::VectorXd time;  // s, from 0
  Eigen::MatrixXd rows;  // one row per sample, one column for each requested one
};

/// Reads `columns` of a CSV, plain or .gz, or of an LCM event log (log_table.hpp). If `separator`
/// names a column, a new recording starts whenever its text changes. Throws import::CsvError naming
/// file, line and column if a cell is not a finite number, time does not increase, or a recording
/// has fewer than two rows.
std::vector<Table> read_tables(const std::string& path, const std::string& time,
                               const std::vector<std::string>& columns,
                               const std::string& separator);

/// Resampled on the grid 0, 1 / rate, ...: the mean over the last `average` seconds, or the latest
/// sample if it is zero or the interval is empty.
Table resample(const Table& table, double rate, double average);

/// The columns delayed by `seconds`: column k at t is its value at t - seconds, on the table's own
/// (uniform) grid; constant beyond the ends.
void delay_columns(Table& table, int first, int count, double seconds);

}  // namespace palpate::recordings
