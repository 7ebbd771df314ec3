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

/// Whether a file is an LCM event log by its content: it begins with the sync word of an event.
/// False for one that cannot be read.
bool is_log(const std::string& path);

/// Reads columns named CHANNEL.field or CHANNEL.field[index] of an LCM event log, such as
/// BIOTAC_0.electrodes[3], FT_WRENCH.wrench[0] or ROBOT_STATE.twist[5]; channels of another arm
/// have its suffix. Each message on the channel of the first column gives a row, with the latest
/// values of every other channel; a gap of more than a second starts a new recording. `time`:
/// "sent" for the senders' time, "received" for that of the log. Throws std::runtime_error naming
/// file and column: another time or form of name, an unknown channel, field or index, a channel
/// missing in the log, a number that is not finite, decreasing time, a recording of fewer than two
/// rows.
std::vector<Table> read_log_tables(const std::string& path, const std::string& time,
                                   const std::vector<std::string>& columns);

/// Reads `columns` of a CSV, plain or .gz, or of an LCM event log (read_log_tables). If `separator`
/// names a column, a new recording starts whenever its text changes. Throws CsvError naming
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
