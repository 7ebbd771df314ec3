#include "tools/common/table.hpp"

#include <algorithm>

namespace palpate::common {
namespace {

/// Characters on the screen: UTF-8 continuation bytes take no space.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

std::string padding(const std::string& text, std::size_t width) {
  return std::string(width - std::min(width, width_of(text)), ' ');
}

}  // namespace

Table::Table(std::vector<std::string> header) : header_(std::move(header)) {}

void Table::add(std::vector<std::string> row) {
  row.resize(header_.size());
  rows_.push_back({false, std::move(row)});
}

void Table::section(const std::string& title) { rows_.push_back({true, {title}}); }

void Table::print(std::ostream& out) const {
  std::vector<std::size_t> widths;
  for (const std::string& title : header_) widths.push_back(width_of(title));
  for (const Row& row : rows_) {
    if (row.is_section) continue;
    for (std::size_t i = 0; i < widths.size(); ++i)
      widths[i] = std::max(widths[i], width_of(row.cells[i]));
  }
  std::size_t total = 0;
  for (const std::size_t width : widths) total += width + 2;

  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string space = padding(cells[i], widths[i]);
      out << (i == 0 ? "" : "  ") << (i == 0 ? cells[i] + space : space + cells[i]);
    }
    out << '\n';
  };
  line(header_);
  out << std::string(total - 2, '-') << '\n';
  for (const Row& row : rows_) {
    if (row.is_section) {
      out << "-- " << row.cells[0] << ' '
          << std::string(total - 2 - std::min(total - 2, width_of(row.cells[0]) + 4), '-') << '\n';
    } else {
      line(row.cells);
    }
  }
}

std::string number(double value, int decimals) { return formatted("%.*f", decimals, value); }

}  // namespace palpate::common
