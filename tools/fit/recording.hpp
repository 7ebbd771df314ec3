#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rt/config/node.hpp"
#include "tools/fit/units.hpp"

namespace palpate::fit {

/// A quantity that an experiment reads from a recording, called `quantity` under `columns`.
struct WantedColumn {
  std::string quantity;
  Dimension dimension;
  const char* meaning;
  bool is_required = true;
  const char* kind = nullptr;  // represents a user-named quantity in the reference
};

/// Samples selected by one of their quantities. In YAML: true (all), false, or {quantity: strain,
/// from: 0.5, to: 1} (SI, ends included; either may be absent).
struct Selection {
  bool is_all = false;
  std::string quantity;  // empty: all or none
  double from = 0;
  double to = 0;

  bool holds(double value) const { return is_all || (value >= from && value <= to); }
};

/// Reads entry `key`; `otherwise` if it is absent. Throws config::Error.
Selection read_selection(const config::Node& node, const config::Key& key, bool otherwise);

/// A number with its unit ("10.65 mm") or in SI (0.01065), returned in SI; the key's unit is the
/// dimension's. Throws config::Error naming the allowed units, or the range.
double read_quantity(const config::Node& node, const config::Key& key, Dimension dimension,
                     config::Range range);
double read_quantity(const config::Node& node, const config::Key& key, Dimension dimension,
                     config::Range range, double otherwise);
/// Empty if the entry is absent: the value is then taken from the recording.
std::optional<double> optional_quantity(const config::Node& node, const config::Key& key,
                                        Dimension dimension, config::Range range);

/// The columns of a CSV (plain or .gz) in SI units. In YAML:
///
///   name: leap_1                 # default: the file's name
///   file: foam/leap_1.csv.gz     # in the folder of the data
///   columns:
///     force: {name: force_N, unit: N, sign: -1}   # sign: default 1
///   where: {probe: 3}            # only rows with this number in a column; optional
///   rows: {first: 100, last: 900, step: 4}        # of the remaining rows, from 0; optional
class Recording {
 public:
  /// Reads the requested columns, all of the same length. Throws config::Error for wrong keys and
  /// units and import::CsvError naming file and row if the file is missing or lacks a column, or a
  /// cell is not a finite number.
  Recording(const config::Node& node, const std::filesystem::path& folder,
            const std::vector<WantedColumn>& wanted);

  const std::string& name() const { return name_; }
  const std::string& path() const { return path_; }
  Eigen::Index rows() const { return static_cast<Eigen::Index>(lines_.size()); }
  bool has(const std::string& quantity) const { return columns_.count(quantity) > 0; }
  /// Throws std::out_of_range if the quantity was not requested or is not available.
  const Eigen::VectorXd& column(const std::string& quantity) const { return columns_.at(quantity); }

  /// Throw import::CsvError, naming file, row and remedy, if there are fewer rows, the quantity is
  /// constant, or it does not increase from row to row.
  void require_rows(Eigen::Index least) const;
  void require_varying(const std::string& quantity) const;
  void require_rising(const std::string& quantity) const;
  /// Throw import::CsvError: "file:line: what", for one row or all.
  [[noreturn]] void fail(Eigen::Index row, const std::string& what) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string name_;
  std::string path_;
  std::map<std::string, Eigen::VectorXd> columns_;
  std::vector<int> lines_;  // of the file, by row
};

/// The distinct numbers in a column, in order of occurrence; for several recordings in one file.
/// Throws import::CsvError.
std::vector<double> distinct_values(const std::filesystem::path& file, const std::string& column);

/// Path of a recording: `file` is relative to `folder` unless it is absolute.
std::filesystem::path recording_path(const std::filesystem::path& folder, const std::string& file);

/// Quantities that a selection may name in addition to the recording's own columns, by sample.
using NamedValues = std::vector<std::pair<std::string, Eigen::VectorXd>>;

/// By sample, whether a selection contains it; empty if it contains none. `sample` (from 0) and the
/// recording's columns may always be named. Throws config::Error if the quantity is unknown.
std::vector<bool> selected_samples(const Selection& selection, const config::Node& node,
                                   const std::string& key, const Recording& recording,
                                   const NamedValues& others);

inline const config::Key kHeldOut("held_out", "",
                                  "samples that are predicted, not fitted: true, or {quantity, "
                                  "from, to}");

/// Entry `held_out` of a recording: samples that are predicted, not fitted (Series::is_held_out).
std::vector<bool> held_out_samples(const config::Node& node, const Recording& recording,
                                   const NamedValues& others);

}  // namespace palpate::fit
