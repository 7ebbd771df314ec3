#include "tools/export/foreign_columns.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace palpate::exporting {
namespace {

/// A number at the start of `text`, which it leaves out; -1: there is none.
std::int64_t leading_number(std::string_view& text) {
  std::int64_t number = -1;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  if (result.ec != std::errc()) return -1;
  text.remove_prefix(static_cast<std::size_t>(result.ptr - text.data()));
  return number;
}

/// "3]" or "0:3]" at the start of `pattern`, which it leaves out; whether `index` is among them.
bool takes_index(std::string_view& pattern, std::int64_t index) {
  const std::int64_t first = leading_number(pattern);
  std::int64_t last = first + 1;
  if (!pattern.empty() && pattern.front() == ':') {
    pattern.remove_prefix(1);
    last = leading_number(pattern);
  }
  if (first < 0 || pattern.empty() || pattern.front() != ']') return false;
  pattern.remove_prefix(1);
  return index >= first && index < last;
}

bool selects_path(std::string_view pattern, std::string_view path) {
  while (!pattern.empty()) {
    if (path.empty() || pattern.front() != path.front()) return false;
    const bool is_index = pattern.front() == '[';
    pattern.remove_prefix(1);
    path.remove_prefix(1);
    if (!is_index) continue;
    const std::int64_t index = leading_number(path);
    path.remove_prefix(1);  // the bracket
    if (!takes_index(pattern, index)) return false;
  }
  // Of a whole array, but not of the members of structs in it.
  return path.empty() || (path.front() == '[' && path.find('.') == std::string_view::npos);
}

}  // namespace

bool ForeignColumns::add(const types::Struct& type, const void* data, int size) {
  const bool fits = types::each_leaf(type, data, size, [this](const types::Leaf& leaf) {
    if (too_wide_) return;
    const auto [found, is_new] = columns_.try_emplace(leaf.key());
    ForeignColumn& column = found->second;
    if (is_new) column = {leaf.path(), &leaf.member(), leaf.is_number(), 0};
    if (leaf.what() == types::Leaf::What::kBytes)
      column.most_bytes =
          std::max(column.most_bytes, static_cast<std::int64_t>(leaf.text().size()));
    too_wide_ = columns_.size() > kMost;
  });
  if (too_wide_) columns_.clear();
  return fits;
}

std::vector<std::vector<std::int64_t>> ForeignColumns::select(const std::string& path) const {
  std::vector<std::vector<std::int64_t>> keys;
  for (const auto& [key, column] : columns_)
    if (column.is_number && selects_path(path, column.path)) keys.push_back(key);
  return keys;
}

}  // namespace palpate::exporting
