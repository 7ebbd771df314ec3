#include "tools/fit/csv_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <mutex>

#include "tools/recordings/csv_reader.hpp"

namespace palpate::fit {
namespace {

/// NaN if the cell is not a finite number.
double parsed(const std::string& cell) {
  const char* const begin = cell.data() + (!cell.empty() && cell.front() == '+' ? 1 : 0);
  const char* const end = cell.data() + cell.size();
  double value = 0;
  const auto [stop, code] = std::from_chars(begin, end, value);
  const bool is_good = code == std::errc() && stop == end && begin != end && std::isfinite(value);
  return is_good ? value : std::numeric_limits<double>::quiet_NaN();
}

std::shared_ptr<const CsvTable> parse(const std::string& path) {
  recordings::CsvReader reader(path);
  auto table = std::make_shared<CsvTable>();
  table->path = path;
  table->header = reader.header();
  table->columns.resize(table->header.size());
  while (reader.next()) {
    for (std::size_t k = 0; k < table->columns.size(); ++k) {
      const std::string& cell = reader.text(static_cast<int>(k));
      table->columns[k].push_back(parsed(cell));
      if (std::isnan(table->columns[k].back())) table->bad_cells[{table->rows(), k}] = cell;
    }
    table->lines.push_back(reader.line());
  }
  return table;
}

struct Kept {
  std::string path;
  std::filesystem::file_time_type changed;
  std::shared_ptr<const CsvTable> table;
};

}  // namespace

std::size_t CsvTable::column(const std::string& name) const {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found != header.end()) return static_cast<std::size_t>(found - header.begin());
  std::string all;
  for (const std::string& known : header) all += (all.empty() ? "'" : ", '") + known + "'";
  throw recordings::CsvError(path + ": no column '" + name + "'; the columns are " + all);
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  const double value = columns[column][row];
  if (!std::isnan(value)) return value;
  throw recordings::CsvError(path + ":" + std::to_string(lines[row]) + ":" + header[column] +
                             ": '" + bad_cells.at({row, column}) +
                             "' is not a finite number; remove the row, or leave it out by `rows`");
}

std::shared_ptr<const CsvTable> read_csv(const std::string& path) {
  constexpr std::size_t kMostKept = 8;
  static std::mutex mutex;
  static std::vector<Kept> all;
  std::error_code error;
  const auto changed = std::filesystem::last_write_time(path, error);
  const std::lock_guard<std::mutex> lock(mutex);
  for (const Kept& kept : all)
    if (kept.path == path && !error && kept.changed == changed) return kept.table;
  std::shared_ptr<const CsvTable> table = parse(path);
  if (all.size() >= kMostKept) all.erase(all.begin());
  all.push_back({path, changed, table});
  return table;
}

}  // namespace palpate::fit
