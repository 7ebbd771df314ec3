#pragma once

#include <cstdio>
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

/// Text by a format of std::printf.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::string text(static_cast<std::size_t>(std::snprintf(nullptr, 0, format, values...)), '\0');
  std::snprintf(text.data(), text.size() + 1, format, values...);
  return text;
}

/// Fixed-point text.
std::string number(double value, int decimals);

}  // namespace palpate::common
