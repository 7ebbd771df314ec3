#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::recordings {

/// An error in a recording; what() reads "file:line: ..." or "file:line:column: ...".
class CsvError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a comma-separated file with a header line, plain or compressed by gzip, row by row.
class CsvReader {
 public:
  /// Throws CsvError if the file cannot be read, has no header or names a column twice.
  explicit CsvReader(const std::string& path);
  ~CsvReader();
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;

  const std::vector<std::string>& header() const { return header_; }
  bool has_column(const std::string& name) const;
  /// 0-based; throws CsvError listing the existing columns.
  int column(const std::string& name) const;

  /// Advances to the next row that is not empty; false at the end of the file. Throws CsvError if
  /// it has more or fewer cells than the header, or the file is damaged.
  bool next();

  const std::string& text(int column) const { return cells_[column]; }
  /// Throws CsvError if the cell is not a finite number.
  double number(int column) const;
  /// Of the current row, 1-based.
  int line() const { return line_; }
  /// Throws CsvError at the current row.
  [[noreturn]] void fail(const std::string& what) const;
  /// Throws CsvError at a cell of the current row.
  [[noreturn]] void fail(int column, const std::string& what) const;

 private:
  struct Input;
  bool read_line(std::string& line);
  void split(const std::string& line);

  std::string path_;
  std::unique_ptr<Input> input_;
  std::vector<std::string> header_;
  std::vector<std::string> cells_;
  int line_ = 0;
};

}  // namespace palpate::recordings
