#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::recordings {

/// Some columns of a recording over time.
struct Table {
  std::string name;      // of the recording
  Eigen::VectorXd time;  // s, from 0
  Eigen::MatrixXd rows;  // a row a sample, a column for each that was asked for
};

/// Reads `columns` of a CSV, plain or .gz, or of an LCM event log (log_table.hpp). Where
/// `separator` names a column, a new recording begins whenever its text changes. Throws
/// import::CsvError naming file, line and column where a cell is not a finite number, time does not
/// rise, or a recording has fewer than two rows.
std::vector<Table> read_tables(const std::string& path, const std::string& time,
                               const std::vector<std::string>& columns,
                               const std::string& separator);

/// On the grid 0, 1 / rate, ...: the mean over the last `average` seconds, or the latest sample
/// where it is zero or nothing lies in them.
Table resample(const Table& table, double rate, double average);

/// The same columns, `seconds` later: column k at t is what it was at t - seconds, on the table's
/// own (uniform) grid; the ends hold the first and last value.
void delay_columns(Table& table, int first, int count, double seconds);

}  // namespace palpate::recordings
