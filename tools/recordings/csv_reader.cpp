#include "tools/recordings/csv_reader.hpp"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

namespace palpate::recordings {
namespace {

/// Without spaces, carriage return and one pair of quotes around it.
std::string trimmed(const std::string& cell) {
  const char* const blank = " \t\r";
  const std::size_t begin = cell.find_first_not_of(blank);
  if (begin == std::string::npos) return "";
  std::string inner = cell.substr(begin, cell.find_last_not_of(blank) - begin + 1);
  if (inner.size() >= 2 && inner.front() == '"' && inner.back() == '"')
    inner = inner.substr(1, inner.size() - 2);
  return inner;
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

struct CsvReader::Input {
  ~Input() {
    if (file != nullptr) gzclose(file);
  }
  gzFile file = nullptr;
};

CsvReader::CsvReader(const std::string& path) : path_(path), input_(std::make_unique<Input>()) {
  errno = 0;
  input_->file = gzopen(path.c_str(), "rb");  // reads plain files as they are
  if (input_->file == nullptr) throw CsvError(path + ": " + std::strerror(errno));
  std::string line;
  if (!read_line(line)) throw CsvError(path + ": the file is empty");
  if (line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);  // byte-order mark
  split(line);
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
      ++line_;
      return true;
    }
  }
  int code = Z_OK;
  const char* const message = gzerror(input_->file, &code);
  // A directory can be opened, but reading fails, indicated only by errno.
  if (code != Z_OK && code != Z_STREAM_END)
    throw CsvError(path_ + ": " + (code == Z_ERRNO ? std::strerror(errno) : message));
  if (line.empty()) return false;
  ++line_;
  return true;
}

void CsvReader::split(const std::string& line) {
  cells_.clear();
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = line.find(',', begin);
    cells_.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string::npos) return;
    begin = comma + 1;
  }
}

bool CsvReader::has_column(const std::string& name) const {
  return std::find(header_.begin(), header_.end(), name) != header_.end();
}

int CsvReader::column(const std::string& name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end())
    throw CsvError(path_ + ": no column '" + name + "'; the columns are " + joined(header_));
  return static_cast<int>(found - header_.begin());
}

bool CsvReader::next() {
  std::string line;
  do {
    if (!read_line(line)) return false;
    split(line);
  } while (cells_.size() == 1 && cells_.front().empty());
  if (cells_.size() != header_.size())
    fail("has " + std::to_string(cells_.size()) + " cells, the header " +
         std::to_string(header_.size()));
  return true;
}

double CsvReader::number(int column) const {
  const std::string& cell = cells_[column];
  const char* const begin = cell.data() + (!cell.empty() && cell.front() == '+' ? 1 : 0);
  const char* const end = cell.data() + cell.size();
  double value = 0;
  const auto [stop, code] = std::from_chars(begin, end, value);
  if (code != std::errc() || stop != end || begin == end)
    fail(column, "'" + cell + "' is not a number");
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
