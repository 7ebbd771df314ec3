#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpate::fit {

/// A CSV as numbers.
struct CsvTable {
  std::string path;
  std::vector<std::string> header;
  std::vector<int> lines;                    // of the file, by row
  std::vector<std::vector<double>> columns;  // NaN for cells that are not finite numbers
  std::map<std::pair<std::size_t, std::size_t>, std::string> bad_cells;  // by row and column

  std::size_t rows() const { return lines.size(); }
  /// Throws import::CsvError with the columns that exist.
  std::size_t column(const std::string& name) const;
  /// Throws import::CsvError naming file, line, column and remedy if there is none.
  double number(std::size_t row, std::size_t column) const;
};

/// Reads a file, plain or .gz. The last few files are cached as long as they are unchanged, since
/// one file may hold several recordings in sequence. Throws import::CsvError if the file cannot be
/// read. Thread-safe.
std::shared_ptr<const CsvTable> read_csv(const std::string& path);

}  // namespace palpate::fit
