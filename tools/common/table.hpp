#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace palpate::common {

/// Rows of text in aligned columns; numbers right-aligned, the first column left-aligned.
class Table {
 public:
  explicit Table(std::vector<std::string> header);
  /// Missing cells stay empty.
  void add(std::vector<std::string> row);
  /// A line that spans all columns, with a title.
  void section(const std::string& title);
  void print(std::ostream& out) const;

 private:
  struct Row {
    bool is_section = false;
    std::vector<std::string> cells;
  };
  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

/// Placeholder for a value that could not be read, or that a run did not provide.
inline constexpr const char* kNotAvailable = "not available";

/// Fixed-point text.
std::string number(double value, int decimals);

}  // namespace palpate::common
