#pragma once

#include <algorithm>

#include "core/math/pack.hpp"

/// Substitution with a dense panel of L (unit diagonal) for several right-hand sides at once, a few
/// rows at a time so that their sums stay in registers.
namespace palpate::factor::substitution {

/// Right-hand sides of one row: kPacks packs.
template <int kPacks>
struct Lanes {
  static constexpr int kWidth = kPacks * math::kLanes<math::Pack4d>;

  Lanes() = default;
  explicit Lanes(const double* source) {
    for (int k = 0; k < kPacks; ++k) packs[k] = math::load(source + 4 * k);
  }
  void store(double* target) const {
    for (int k = 0; k < kPacks; ++k) math::store(packs[k], target + 4 * k);
  }
  void subtract(double factor, const Lanes& other) {
    for (int k = 0; k < kPacks; ++k) packs[k] -= factor * other.packs[k];
  }
  void scale(double factor) {
    for (math::Pack4d& pack : packs) pack *= factor;
  }

  math::Pack4d packs[kPacks];
};

/// Column-major, with distance `stride` between columns; the lanes of row i begin at
/// lanes[offsets[i]].
struct Panel {
  const double* entries;
  int stride, columns, rows;
  const int* offsets;
  double* lanes;

  double* row(int i) const { return lanes + offsets[i]; }
};

template <int kPacks, int kRows>
inline void forward_rows(const Panel& p, int i) {
  Lanes<kPacks> sums[kRows];
  for (int r = 0; r < kRows; ++r) sums[r] = Lanes<kPacks>(p.row(i + r));
  const double* column = p.entries + i;
  const int before = std::min(i, p.columns);
  for (int j = 0; j < before; ++j, column += p.stride) {
    const Lanes<kPacks> x(p.row(j));
    for (int r = 0; r < kRows; ++r) sums[r].subtract(column[r], x);
  }
  for (int j = 0; j + 1 < kRows && i + j < p.columns; ++j, column += p.stride) {
    for (int r = j + 1; r < kRows; ++r) sums[r].subtract(column[r], sums[j]);
  }
  for (int r = 0; r < kRows; ++r) sums[r].store(p.row(i + r));
}

template <int kPacks, int kColumns>
inline void backward_columns(const Panel& p, int j) {
  const double* columns[kColumns];
  Lanes<kPacks> sums[kColumns];
  for (int c = 0; c < kColumns; ++c) {
    columns[c] = p.entries + static_cast<std::ptrdiff_t>(j + c) * p.stride;
    sums[c] = Lanes<kPacks>(p.row(j + c));
  }
  for (int i = j + kColumns; i < p.rows; ++i) {
    const Lanes<kPacks> x(p.row(i));
    for (int c = 0; c < kColumns; ++c) sums[c].subtract(columns[c][i], x);
  }
  for (int c = kColumns - 1; c > 0; --c) {
    for (int d = 0; d < c; ++d) sums[d].subtract(columns[d][j + c], sums[c]);
  }
  for (int c = 0; c < kColumns; ++c) sums[c].store(p.row(j + c));
}

/// x <- L^-1 x over the panel's columns; subtracts their contribution from the rows below them.
template <int kPacks>
inline void forward(const Panel& p) {
  int i = 0;
  for (; i + 6 <= p.rows; i += 6) forward_rows<kPacks, 6>(p, i);
  for (; i + 3 <= p.rows; i += 3) forward_rows<kPacks, 3>(p, i);
  for (; i < p.rows; ++i) forward_rows<kPacks, 1>(p, i);
}

/// x <- L^-T x over the panel's columns, with the rows below them known.
template <int kPacks>
inline void backward(const Panel& p) {
  int j = p.columns;
  for (; j >= 6; j -= 6) backward_columns<kPacks, 6>(p, j - 6);
  for (; j >= 3; j -= 3) backward_columns<kPacks, 3>(p, j - 3);
  for (; j >= 1; --j) backward_columns<kPacks, 1>(p, j - 1);
}

/// Divides consecutive rows by d.
template <int kPacks>
inline void divide(double* lanes, const double* d, int rows) {
  using Row = Lanes<kPacks>;
  for (int i = 0; i < rows; ++i, lanes += Row::kWidth) {
    Row row(lanes);
    row.scale(1 / d[i]);
    row.store(lanes);
  }
}

}  // namespace palpate::factor::substitution
