#include "core/factor/panel_inverse.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "core/factor/panel_kernel.hpp"

namespace palpate::factor {
namespace {

using panel_kernel::kTile;
using panel_kernel::load;
using panel_kernel::store;

/// X for kTiles tiles of rows, whose columns from `end` on are zero: from the last group of columns
/// to the first, each of which subtracts the product of the columns behind it with their rows of
/// L11.
template <int kTiles>
void solve_tiles(const float* right, int columns, int end, float* x) {
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(columns) * kTile;
  for (int g = (end - 1) / kInverseGroup * kInverseGroup; g >= 0; g -= kInverseGroup) {
    const int width = std::min(kInverseGroup, end - g);
    const float* factors = right + static_cast<std::ptrdiff_t>(g) * columns + g * kInverseGroup;
    float* own = x + g * kTile;
    panel_kernel::Lanes sums[kTiles][kInverseGroup], column;
    for (int t = 0; t < kTiles; ++t) {
      for (int c = 0; c < kInverseGroup; ++c) {
        if (c < width) {
          load(own + t * stride + c * kTile, sums[t][c]);
        } else {
          sums[t][c] = panel_kernel::Lanes{};
        }
      }
    }
    for (int k = kInverseGroup; k < end - g; ++k) {
      const float* factor = factors + k * kInverseGroup;
      for (int t = 0; t < kTiles; ++t) {
        load(own + t * stride + k * kTile, column);
        for (int c = 0; c < kInverseGroup; ++c) sums[t][c] -= column * factor[c];
      }
    }
    for (int k = kInverseGroup - 1; k > 0; --k) {
      for (int c = 0; c < k; ++c) {
        for (int t = 0; t < kTiles; ++t) sums[t][c] -= sums[t][k] * factors[k * kInverseGroup + c];
      }
    }
    for (int t = 0; t < kTiles; ++t) {
      for (int c = 0; c < width; ++c) store(sums[t][c], own + t * stride + c * kTile);
    }
  }
}

/// A tile of -L21, column by column.
void load_below(const double* lower, int columns, int rows, int first, float* x) {
  using Doubles = double __attribute__((vector_size(64)));
  if (first + kTile > rows) {
    for (int c = 0; c < columns; ++c, lower += rows, x += kTile) {
      for (int r = 0; r < kTile; ++r) x[r] = first + r < rows ? -static_cast<float>(lower[r]) : 0;
    }
    return;
  }
  for (int c = 0; c < columns; ++c, lower += rows, x += kTile) {
    Doubles source;
    std::memcpy(&source, lower, sizeof source);
    store(-__builtin_convertvector(source, panel_kernel::Lanes), x);
  }
}

}  // namespace

void invert_panel(const double* lower, int columns, int rows, float* right, float* left) noexcept {
  // rows of L11 from each group of columns on, the columns of the group adjacent
  for (int g = 0; g < columns; g += kInverseGroup) {
    float* target = right + static_cast<std::ptrdiff_t>(g) * columns + g * kInverseGroup;
    const double* source = lower + static_cast<std::ptrdiff_t>(g) * rows + g;
    const int width = std::min(kInverseGroup, columns - g);
    for (int k = 0; k < std::max(kInverseGroup, columns - g); ++k, target += kInverseGroup) {
      for (int c = 0; c < kInverseGroup; ++c) {
        const bool is_inside = c < width && k < columns - g;
        target[c] = is_inside ? static_cast<float>(source[c * rows + k]) : 0;
      }
    }
  }
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(columns) * kTile;
  const int tiles = panel_kernel::tiles_of(rows);
  int tile = 0;
  for (; tile * kTile < columns; ++tile) {  // the last one may contain rows of both parts
    const int first = tile * kTile, end = std::min(columns, first + kTile);
    float* x = left + tile * stride;
    for (int c = 0; c < end; ++c) {
      const double* source = lower + static_cast<std::ptrdiff_t>(c) * rows + first;
      for (int r = 0; r < kTile; ++r) {
        const int row = first + r;
        const double value = row >= rows ? 0 : row >= columns ? -source[r] : row == c ? 1 : 0;
        x[c * kTile + r] = static_cast<float>(value);
      }
    }
    solve_tiles<1>(right, columns, end, x);
  }
  while (tile < tiles) {
    const int count = std::min(2, tiles - tile);
    float* x = left + tile * stride;
    for (int t = 0; t < count; ++t) {
      const int first = (tile + t) * kTile;
      load_below(lower + first, columns, rows, first, x + t * stride);
    }
    if (count == 2) {
      solve_tiles<2>(right, columns, columns, x);
    } else {
      solve_tiles<1>(right, columns, columns, x);
    }
    tile += count;
  }
}

}  // namespace palpate::factor
