#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace palpate::common {

/// Rows of text in aligned columns; numbers to the right, the first column to the left.
class Table {
 public:
  explicit Table(std::vector<std::string> header);
  /// Missing cells stay empty.
  void add(std::vector<std::string> row);
  /// A line across, with a title.
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

/// What a value is called that nobody could read, or that a run did not give.
inline constexpr const char* kNotAvailable = "not available";

/// Fixed-point text.
std::string number(double value, int decimals);

}  // namespace palpate::common
