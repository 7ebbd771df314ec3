#include "core/mesh/mesh_reader.hpp"

#include <numeric>
#include <sstream>

#include "core/math/parse_number.hpp"

namespace palpate::mesh {

void MeshWithGroups::number_from(long first) {
  node_numbers.resize(mesh.node_count());
  std::iota(node_numbers.begin(), node_numbers.end(), first);
  tetrahedron_numbers.resize(mesh.tetrahedron_count());
  std::iota(tetrahedron_numbers.begin(), tetrahedron_numbers.end(), first);
}

bool LineReader::next() {
  while (std::getline(stream_, line_)) {
    ++line_number_;
    if (comment_ != '\0') line_ = line_.substr(0, line_.find(comment_));
    words_.clear();
    std::istringstream split(line_);
    for (std::string word; split >> word;) words_.push_back(word);
    if (words_.empty()) continue;
    const char* kSpace = " \t\r\v\f";
    line_ = line_.substr(line_.find_first_not_of(kSpace));
    line_.erase(line_.find_last_not_of(kSpace) + 1);
    return true;
  }
  words_.clear();
  line_.clear();
  return false;
}

void LineReader::require(const std::string& expected) {
  if (!next()) fail("the file ends before " + expected);
}

const std::string& LineReader::word(int i) const {
  if (i >= size()) {
    fail("has " + std::to_string(size()) + " columns, at least " + std::to_string(i + 1) +
         " are needed");
  }
  return words_[i];
}

double LineReader::number(int i) const {
  double value = 0;
  if (!math::parse_number(word(i), value)) fail("'" + word(i) + "' is not a number");
  return value;
}

long LineReader::integer(int i) const {
  long value = 0;
  if (!math::parse_number(word(i), value)) fail("'" + word(i) + "' is not a whole number");
  return value;
}

int LineReader::count(int i) const {
  constexpr long kMost = 100'000'000;
  const long value = integer(i);
  if (value < 0 || value > kMost) fail("'" + word(i) + "' is no sensible count");
  return static_cast<int>(value);
}

void LineReader::fail(const std::string& what) const {
  throw ParseError(name_ + ":" + std::to_string(line_number_) + ": " + what);
}

}  // namespace palpate::mesh
