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

struct CsvOptions {
  /// ',', ';' or '\t'; 0: the one that the header line has most of, a comma where it has none.
  char delimiter = 0;
};

/// Reads a file of delimited values with a header line, plain or compressed by gzip, row by row.
/// Cells are quoted as RFC 4180 says: "a ""b"", c" may hold delimiters and line breaks. Blanks
/// around a cell do not count.
class CsvReader {
 public:
  /// Throws CsvError if the file cannot be read, has no header or names a column twice.
  explicit CsvReader(const std::string& path, const CsvOptions& options = {});
  ~CsvReader();
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;

  const std::vector<std::string>& header() const { return header_; }
  char delimiter() const { return delimiter_; }
  bool has_column(const std::string& name) const;
  /// 0-based; throws CsvError listing the existing columns.
  int column(const std::string& name) const;
  /// Throws CsvError with all of the names that are no columns, and with the columns that exist.
  void require_columns(const std::vector<std::string>& names) const;

  /// Advances to the next row that is not empty; false at the end of the file. Throws CsvError if
  /// it has more or fewer cells than the header, or the file is damaged.
  bool next();

  const std::string& text(int column) const { return cells_[column]; }
  /// Throws CsvError if the cell is not a finite number.
  double number(int column) const;
  /// Where the current row begins, 1-based.
  int line() const { return line_; }
  /// Throws CsvError at the current row.
  [[noreturn]] void fail(const std::string& what) const;
  /// Throws CsvError at a cell of the current row.
  [[noreturn]] void fail(int column, const std::string& what) const;

 private:
  struct Input;
  bool read_line(std::string& line);
  void split(std::string line);
  std::size_t read_quoted(std::string& line, std::size_t at, std::string& cell);

  std::string path_;
  std::unique_ptr<Input> input_;
  std::vector<std::string> header_;
  std::vector<std::string> cells_;
  char delimiter_ = ',';
  int lines_read_ = 0;
  int line_ = 0;
};

}  // namespace palpate::recordings
