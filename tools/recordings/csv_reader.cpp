#include "tools/recordings/csv_reader.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/math/parse_number.hpp"

namespace palpate::recordings {
namespace {

constexpr std::size_t kLongestCell = 1 << 20;  // bytes: a quote that is not closed ends here

/// The delimiter that stands most often outside of quotes; a comma where there is none.
char most_frequent_delimiter(const std::string& line) {
  constexpr std::array<char, 3> kDelimiters = {',', ';', '\t'};
  std::array<int, 3> counts{};
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    const auto found = std::find(kDelimiters.begin(), kDelimiters.end(), c);
    if (!is_quoted && found != kDelimiters.end()) ++counts[found - kDelimiters.begin()];
  }
  return kDelimiters[std::max_element(counts.begin(), counts.end()) - counts.begin()];
}

std::string joined(const std::vector<std::string>& names, const std::string& between) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : between) + name;
  return list;
}

}  // namespace

struct CsvReader::Input {
  ~Input() {
    if (file != nullptr) gzclose(file);
  }
  gzFile file = nullptr;
};

CsvReader::CsvReader(const std::string& path, const CsvOptions& options)
    : path_(path), input_(std::make_unique<Input>()), delimiter_(options.delimiter) {
  if (delimiter_ != 0 && delimiter_ != ',' && delimiter_ != ';' && delimiter_ != '\t')
    throw std::invalid_argument(std::string("delimiter '") + delimiter_ +
                                "' is none of comma, semicolon and tab");
  errno = 0;
  input_->file = gzopen(path.c_str(), "rb");  // reads plain files as they are
  if (input_->file == nullptr) throw CsvError(path + ": " + std::strerror(errno));
  std::string line;
  if (!read_line(line)) throw CsvError(path + ": the file is empty");
  if (line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);  // byte-order mark
  if (delimiter_ == 0) delimiter_ = most_frequent_delimiter(line);
  split(std::move(line));
  header_ = cells_;
  std::vector<std::string> sorted = header_;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) fail("two columns are named '" + *twice + "'");
}

CsvReader::~CsvReader() = default;

bool CsvReader::read_line(std::string& line) {
  line.clear();
  char chunk[4096];
  while (gzgets(input_->file, chunk, sizeof(chunk)) != nullptr) {
    line += chunk;
    if (line.back() == '\n') {
      line.pop_back();
      ++lines_read_;
      return true;
    }
  }
  int code = Z_OK;
  const char* const message = gzerror(input_->file, &code);
  // A directory can be opened, but reading fails, indicated only by errno.
  if (code != Z_OK && code != Z_STREAM_END)
    throw CsvError(path_ + ": " + (code == Z_ERRNO ? std::strerror(errno) : message));
  if (line.empty()) return false;
  ++lines_read_;
  return true;
}

/// Appends to `cell` what stands from `at` up to the closing quote, over as many lines as it takes;
/// returns the place behind that quote, in the line that is then in `line`.
std::size_t CsvReader::read_quoted(std::string& line, std::size_t at, std::string& cell) {
  while (true) {
    const std::size_t quote = line.find('"', at);
    cell.append(line, at, quote == std::string::npos ? quote : quote - at);
    if (quote == std::string::npos) {
      cell += '\n';
      if (cell.size() > kLongestCell || !read_line(line))
        fail("cell " + std::to_string(cells_.size()) + ": its quote is not closed");
      at = 0;
    } else if (line.compare(quote + 1, 1, "\"") == 0) {
      cell += '"';
      at = quote + 2;
    } else {
      return quote + 1;
    }
  }
}

void CsvReader::split(std::string line) {
  line_ = lines_read_;
  cells_.clear();
  const std::string blank = delimiter_ == '\t' ? " \r" : " \t\r";
  const auto behind_blanks = [&](std::size_t from) {
    return std::min(line.find_first_not_of(blank, from), line.size());
  };
  for (std::size_t at = 0;; ++at) {
    std::string& cell = cells_.emplace_back();
    at = behind_blanks(at);
    if (at < line.size() && line[at] == '"') {
      at = behind_blanks(read_quoted(line, at + 1, cell));
      if (at < line.size() && line[at] != delimiter_)
        fail("cell " + std::to_string(cells_.size()) + ": there is text behind its closing quote");
    } else {
      const std::size_t end = std::min(line.find(delimiter_, at), line.size());
      cell = line.substr(at, end - at);
      cell.erase(cell.find_last_not_of(blank) + 1);
      at = end;
    }
    if (at >= line.size()) return;
  }
}

bool CsvReader::has_column(const std::string& name) const {
  return std::find(header_.begin(), header_.end(), name) != header_.end();
}

int CsvReader::column(const std::string& name) const {
  require_columns({name});
  return static_cast<int>(std::find(header_.begin(), header_.end(), name) - header_.begin());
}

void CsvReader::require_columns(const std::vector<std::string>& names) const {
  std::vector<std::string> missing;
  for (const std::string& name : names) {
    if (!has_column(name) && std::find(missing.begin(), missing.end(), name) == missing.end())
      missing.push_back(name);
  }
  if (missing.empty()) return;
  throw CsvError(path_ + ": no column" + (missing.size() > 1 ? "s" : "") + " '" +
                 joined(missing, "', '") + "'; the columns are " + joined(header_, ", "));
}

bool CsvReader::next() {
  std::string line;
  do {
    if (!read_line(line)) return false;
    split(std::move(line));
  } while (cells_.size() == 1 && cells_.front().empty());
  if (cells_.size() != header_.size())
    fail("has " + std::to_string(cells_.size()) + " cells, the header " +
         std::to_string(header_.size()));
  return true;
}

double CsvReader::number(int column) const {
  const std::string& cell = cells_[column];
  double value = 0;
  if (!math::parse_number(cell, value))
    fail(column, "'" + cell + "' is not a number" +
                     (cell.find(',') != std::string::npos ? "; decimals have a point" : ""));
  if (!std::isfinite(value)) fail(column, "'" + cell + "' is not finite");
  return value;
}

void CsvReader::fail(const std::string& what) const {
  throw CsvError(path_ + ":" + std::to_string(line_) + ": " + what);
}

void CsvReader::fail(int column, const std::string& what) const {
  throw CsvError(path_ + ":" + std::to_string(line_) + ":" + header_[column] + ": " + what);
}

}  // namespace palpate::recordings
