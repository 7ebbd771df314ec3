#include "tools/fit/recording.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "tools/recordings/csv_reader.hpp"

namespace palpate::fit {
namespace {

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

/// Reads a file, plain or .gz. The last few files are cached as long as they are unchanged, since
/// one file may hold several recordings in sequence. Throws import::CsvError if the file cannot be
/// read. Thread-safe.
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

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

std::string joined(const std::vector<std::string>& texts) {
  std::string result;
  for (const std::string& text : texts) result += (result.empty() ? "'" : ", '") + text + "'";
  return result;
}

/// Throws config::Error at `key` if the unit is not one of the dimension's.
double factor_of(const config::Node& node, const std::string& key, Dimension dimension,
                 const std::string& unit) {
  const double factor = si_factor(dimension, unit);
  if (factor == 0)
    node.fail(key, "'" + unit + "' is no unit of " + name_of(dimension) +
                       "; allowed: " + joined(units_of(dimension)));
  return factor;
}

/// A column of the file and its conversion to a quantity.
struct Source {
  std::string quantity;
  std::size_t column = 0;
  double factor = 1;
};

std::vector<Source> read_sources(const config::Node& node, const CsvTable& table,
                                 const std::vector<WantedColumn>& wanted) {
  const config::Node columns =
      node.child({"columns", "", "where each quantity stands in the file"});
  std::vector<Source> sources;
  for (const WantedColumn& want : wanted) {
    config::Key key(want.quantity, si_unit(want.dimension), want.meaning);
    key.kind = want.kind;
    if (!columns.has(want.quantity)) {
      if (want.is_required)
        columns.fail(want.quantity,
                     "is absent; it names the column of " + name_of(want.dimension) +
                         " as {name: ..., unit: " + units_of(want.dimension).front() + "}");
      continue;
    }
    const config::Node entry = columns.child(key);
    Source source;
    source.quantity = want.quantity;
    source.column = table.column(entry.text({"name", "", "of the column"}));
    const std::string unit = entry.text({"unit", "", "of its numbers; absent: the one of SI"},
                                        units_of(want.dimension).front());
    source.factor = factor_of(entry, "unit", want.dimension, unit) *
                    entry.number({"sign", "", "-1 turns them round"}, {-1, 1}, 1);
    if (source.factor == 0) entry.fail("sign", "must be 1 or -1");
    sources.push_back(source);
  }
  return sources;
}

struct Filter {
  std::size_t column = 0;
  double value = 0;
};

std::vector<Filter> read_filters(const config::Node& node, const CsvTable& table) {
  std::vector<Filter> filters;
  if (!node.has("where")) return filters;
  const config::Node where =
      node.child({"where", "", "only rows that have these numbers in these columns"});
  for (const std::string& column : where.keys()) {
    const config::Key key = config::Key::named_by_user(column, "COLUMN", "", "in that column");
    filters.push_back({table.column(column), where.number(key, {-kUnlimited, kUnlimited})});
  }
  return filters;
}

}  // namespace

Selection read_selection(const config::Node& node, const config::Key& key, bool otherwise) {
  Selection selection;
  if (!node.is_mapping(key.name)) {
    selection.is_all = node.flag(key, otherwise);
    selection.from = 1;  // above `to`: none
    return selection;
  }
  const config::Node entry = node.child(key);
  selection.quantity = entry.text({"quantity", "", "that selects the samples"});
  selection.from = entry.number({"from", "SI", "its least, of these"}, {}, -kUnlimited);
  selection.to = entry.number({"to", "SI", "its greatest, of these"}, {}, kUnlimited);
  if (!(selection.from <= selection.to)) entry.fail("to", "must not be below from");
  return selection;
}

namespace {

/// The quantity, which must exist and be declared.
double to_quantity(const config::Node& node, const std::string& key, Dimension dimension,
                   config::Range range) {
  const std::string text = node.text(key);
  const std::size_t gap = text.find(' ');
  if (gap == std::string::npos) return node.number(key, range);
  double value = 0;
  try {
    std::size_t used = 0;
    value = std::stod(text, &used);
    if (used != gap) throw std::invalid_argument(text);
  } catch (const std::exception&) {
    node.fail(key, "'" + text + "' is not a number with a unit");
  }
  value *= factor_of(node, key, dimension, text.substr(gap + 1));
  if (!(value >= range.lower && value <= range.upper))
    node.fail(key, "is out of range; allowed: " + std::to_string(range.lower) + " to " +
                       std::to_string(range.upper) + " " + si_unit(dimension));
  return value;
}

config::Key in_si(config::Key key, Dimension dimension) {
  key.unit = si_unit(dimension);
  return key;
}

}  // namespace

double read_quantity(const config::Node& node, const config::Key& key, Dimension dimension,
                     config::Range range) {
  node.declare_quantity(in_si(key, dimension), range, true);
  return to_quantity(node, key.name, dimension, range);
}

double read_quantity(const config::Node& node, const config::Key& key, Dimension dimension,
                     config::Range range, double otherwise) {
  std::ostringstream text;
  text << otherwise;
  node.declare_quantity(in_si(key, dimension), range, false, text.str());
  return node.has(key.name) ? to_quantity(node, key.name, dimension, range) : otherwise;
}

std::optional<double> optional_quantity(const config::Node& node, const config::Key& key,
                                        Dimension dimension, config::Range range) {
  node.declare_quantity(in_si(key, dimension), range, false);
  if (!node.has(key.name)) return std::nullopt;
  return to_quantity(node, key.name, dimension, range);
}

Recording::Recording(const config::Node& node, const std::filesystem::path& folder,
                     const std::vector<WantedColumn>& wanted) {
  const std::string file = node.text({"file", "", "CSV, plain or .gz, in the folder of the data"});
  path_ = recording_path(folder, file).string();
  const std::string stem = std::filesystem::path(file).filename().string();
  const std::string by_file = stem.substr(0, stem.find(".csv"));
  const std::string own = node.text({"name", "", "of the recording; absent: the file's"}, "");
  name_ = own.empty() ? by_file : own;

  const std::shared_ptr<const CsvTable> table = read_csv(path_);
  const std::vector<Source> sources = read_sources(node, *table, wanted);
  const std::vector<Filter> filters = read_filters(node, *table);
  const config::Node rows = node.child_or_empty({"rows", "", "which of those that are left"});
  const int first = rows.integer({"first", "", "counted from 0"}, {0, 1e9}, 0);
  const int last =
      rows.integer({"last", "", "this one too; absent: to the end"}, {0, 1e9}, 1000000000);
  const int step = rows.integer({"step", "", "each so-and-so-many-th"}, {1, 1e6}, 1);

  std::vector<std::vector<double>> cells(sources.size());
  int index = -1;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const bool is_ours = std::all_of(filters.begin(), filters.end(), [&](const Filter& f) {
      return table->number(row, f.column) == f.value;
    });
    if (!is_ours) continue;
    ++index;
    if (index < first || index > last || (index - first) % step != 0) continue;
    for (std::size_t k = 0; k < sources.size(); ++k)
      cells[k].push_back(sources[k].factor * table->number(row, sources[k].column));
    lines_.push_back(table->lines[row]);
  }
  for (std::size_t k = 0; k < sources.size(); ++k)
    columns_[sources[k].quantity] = Eigen::Map<const Eigen::VectorXd>(
        cells[k].data(), static_cast<Eigen::Index>(cells[k].size()));
}

void Recording::require_rows(Eigen::Index least) const {
  if (rows() < least)
    fail(rows() > 0 ? rows() - 1 : 0,
         "only " + std::to_string(rows()) + " samples; " + std::to_string(least) +
             " are needed: check `where` and `rows`, or record longer");
}

void Recording::require_varying(const std::string& quantity) const {
  const Eigen::VectorXd& values = column(quantity);
  if (values.size() > 0 && values.maxCoeff() > values.minCoeff()) return;
  fail(0, quantity + " is the same in every row (" +
              (values.size() > 0 ? std::to_string(values[0]) : "none") +
              "): nothing can be learnt from it; check the column's name");
}

void Recording::require_rising(const std::string& quantity) const {
  const Eigen::VectorXd& values = column(quantity);
  for (Eigen::Index row = 1; row < values.size(); ++row)
    if (!(values[row] > values[row - 1]))
      fail(row, quantity +
                    " does not rise from the row before; sort the rows, or remove those "
                    "that repeat");
}

void Recording::fail(Eigen::Index row, const std::string& what) const {
  const auto index = static_cast<std::size_t>(row);
  throw recordings::CsvError(
      path_ + ":" + std::to_string(index < lines_.size() ? lines_[index] : 1) + ": " + what);
}

void Recording::fail(const std::string& what) const {
  throw recordings::CsvError(path_ + ": " + what);
}

std::vector<double> distinct_values(const std::filesystem::path& file, const std::string& column) {
  const std::shared_ptr<const CsvTable> table = read_csv(file.string());
  const std::size_t index = table->column(column);
  std::vector<double> values;
  std::unordered_set<double> known;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const double value = table->number(row, index);
    if (known.insert(value).second) values.push_back(value);
  }
  return values;
}

std::filesystem::path recording_path(const std::filesystem::path& folder, const std::string& file) {
  return folder / file;
}

std::vector<bool> selected_samples(const Selection& selection, const config::Node& node,
                                   const std::string& key, const Recording& recording,
                                   const NamedValues& others) {
  const auto count =
      static_cast<std::size_t>(others.empty() ? recording.rows() : others.front().second.size());
  if (selection.quantity.empty())
    return selection.is_all ? std::vector<bool>(count, true) : std::vector<bool>();
  Eigen::VectorXd values;
  const auto other = std::find_if(others.begin(), others.end(), [&](const auto& entry) {
    return entry.first == selection.quantity;
  });
  if (other != others.end()) {
    values = other->second;
  } else if (selection.quantity == "sample") {
    values.setLinSpaced(static_cast<Eigen::Index>(count), 0, static_cast<double>(count) - 1);
  } else if (recording.has(selection.quantity)) {
    values = recording.column(selection.quantity);
  } else {
    std::string known = "'sample'";
    for (const auto& entry : others) known += ", '" + entry.first + "'";
    node.fail(
        key, "knows no quantity '" + selection.quantity + "'; allowed: " + known + ", or a column");
  }
  std::vector<bool> selected(static_cast<std::size_t>(values.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) selected[i] = selection.holds(values[i]);
  return selected;
}

std::vector<bool> held_out_samples(const config::Node& node, const Recording& recording,
                                   const NamedValues& others) {
  return selected_samples(read_selection(node, kHeldOut, false), node, "held_out", recording,
                          others);
}

}  // namespace palpate::fit
