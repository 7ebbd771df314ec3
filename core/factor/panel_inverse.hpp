#pragma once

#include <cstddef>

namespace palpate::factor {

/// Columns that are computed at once below.
inline constexpr int kInverseGroup = 6;

/// Length of the workspace `right` for panels of at most `columns` columns.
inline std::size_t inverse_workspace(int columns) {
  const auto padded = static_cast<std::size_t>(columns + kInverseGroup);
  return padded * padded;
}

/// X = [inv(L11); -L21 inv(L11)], computed in single precision like the solves with it, which have
/// errors of the same order. lower: columns of L, column-major, each of length `rows`, with a unit
/// diagonal that is not read. X is written to `left` tile by tile of panel_kernel::kTile rows,
/// column by column; tiles above the diagonal are not written.
void invert_panel(const double* lower, int columns, int rows, float* right, float* left) noexcept;

}  // namespace palpate::factor
