#pragma once

#include <vector>

#include "core/factor/block_matrix.hpp"

namespace palpate::factor {

/// Symbolic factor of the interior of a pattern: runs of columns with nearly the same rows, kept as
/// dense panels. Runs are merged where the zeros that this adds cost a triangular solve less than
/// another panel would. Unknowns are numbered as in the pattern, which must outlive this.
class Supernodes {
 public:
  explicit Supernodes(const BlockPattern& pattern);
  explicit Supernodes(BlockPattern&&) = delete;

  const BlockPattern& pattern() const { return *pattern_; }
  int count() const { return static_cast<int>(begin_.size()) - 1; }

  /// Columns begin(s) to end(s) - 1; supernodes follow each other in postorder.
  int begin(int s) const { return begin_[s]; }
  int end(int s) const { return begin_[s + 1]; }
  int columns(int s) const { return end(s) - begin(s); }

  /// Unknowns below the columns, rising; those of the border come last.
  const int* rows_begin(int s) const { return rows_.data() + row_start_[s]; }
  const int* rows_end(int s) const { return rows_.data() + row_start_[s + 1]; }
  int rows(int s) const { return row_start_[s + 1] - row_start_[s]; }

  /// Supernode that holds the first row of s; count() where that is the border or there is none.
  int parent(int s) const { return parent_[s]; }

  /// Of a solve's work on the panel of s, in scalars read.
  double cost(int s) const;

  /// Scalars of the panels' factor, zeros of merged columns included, the border left out.
  long entries() const;

 private:
  const BlockPattern* pattern_;
  std::vector<int> begin_{0}, row_start_{0}, rows_, parent_;
};

}  // namespace palpate::factor
