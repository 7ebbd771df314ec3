#pragma once

#include <vector>

#include "core/factor/block_matrix.hpp"

namespace palpate::factor {

/// Symbolic factor of the interior of a pattern: runs of columns with nearly equal rows, stored as
/// dense panels. Runs are merged if the added zeros cost a triangular solve less than an additional
/// panel. Unknowns are numbered as in the pattern, which must outlive this object.
class Supernodes {
 public:
  explicit Supernodes(const BlockPattern& pattern);
  explicit Supernodes(BlockPattern&&) = delete;

  const BlockPattern& pattern() const { return *pattern_; }
  int count() const { return static_cast<int>(begin_.size()) - 1; }

  /// Columns begin(s) to end(s) - 1; supernodes are in postorder.
  int begin(int s) const { return begin_[s]; }
  int end(int s) const { return begin_[s + 1]; }
  int columns(int s) const { return end(s) - begin(s); }

  /// Unknowns below the columns, ascending; those of the border come last.
  const int* rows_begin(int s) const { return rows_.data() + row_start_[s]; }
  const int* rows_end(int s) const { return rows_.data() + row_start_[s + 1]; }
  int rows(int s) const { return row_start_[s + 1] - row_start_[s]; }

  /// Supernode that contains the first row of s; count() if that row is in the border or s has no
  /// rows.
  int parent(int s) const { return parent_[s]; }

  /// Cost of a solve with the panel of s, in scalars read.
  double cost(int s) const;

  /// Scalars in all panels, including zeros of merged columns, without the border.
  long entries() const;

 private:
  const BlockPattern* pattern_;
  std::vector<int> begin_{0}, row_start_{0}, rows_, parent_;
};

}  // namespace palpate::factor
