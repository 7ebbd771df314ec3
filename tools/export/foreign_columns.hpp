#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/types/leaves.hpp"

namespace palpate::exporting {

/// A number, text or block of bytes of a type that is known by its .lcm description only.
struct ForeignColumn {
  std::string path;  // as contacts[2].force[0]
  const types::Member* member = nullptr;
  bool is_number = false;
  std::int64_t most_bytes = 0;  // in a block of bytes
};

/// The columns that messages of one type on one channel fill, in the order of the description:
/// arrays are as long as their longest one.
class ForeignColumns {
 public:
  using Map = std::map<std::vector<std::int64_t>, ForeignColumn>;
  static constexpr std::size_t kMost = 20'000;

  /// False, without effect, if the message does not fit its type.
  bool add(const types::Struct& type, const void* data, int size);

  /// By types::Leaf::key(); empty if there would be more than kMost.
  const Map& columns() const { return columns_; }
  bool is_too_wide() const { return too_wide_; }

  /// Keys of the numbers that a path selects: of one number, of all numbers of an array, or of
  /// ranges in it, as points[0:3].x.
  std::vector<std::vector<std::int64_t>> select(const std::string& path) const;

 private:
  Map columns_;
  bool too_wide_ = false;
};

}  // namespace palpate::exporting
