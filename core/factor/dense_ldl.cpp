#include "core/factor/supernodal_factor.hpp"

#include <cmath>

namespace palpate::factor {
namespace {

constexpr int kBlock = 32;       // columns eliminated at once
constexpr double kZero = 1e-11;  // relative to the scale: rounding error of a vanishing pivot

// Four doubles in one register, or in two or four where registers are smaller.
using Lanes = double __attribute__((vector_size(32)));
// The same with the alignment of a double. Packed, because clang ignores the alignment of a type
// alias.
struct __attribute__((packed, may_alias)) Unaligned {
  Lanes all;
};

Unaligned& lanes(double* p) { return *reinterpret_cast<Unaligned*>(p); }
const Unaligned& lanes(const double* p) { return *reinterpret_cast<const Unaligned*>(p); }

}  // namespace

void subtract_product(const double* a, const double* b, int depth, int rows, int columns,
                      double* target, std::ptrdiff_t stride) noexcept {
  Lanes sums[kTileColumns][2];
  for (int c = 0; c < kTileColumns; ++c) sums[c][0] = sums[c][1] = Lanes{};
  for (int k = 0; k < depth; ++k, a += kTileRows, b += kTileColumns) {
    const Lanes low = lanes(a).all, high = lanes(a + 4).all;
    for (int c = 0; c < kTileColumns; ++c) {
      sums[c][0] += low * b[c];
      sums[c][1] += high * b[c];
    }
  }
  if (rows == kTileRows && columns == kTileColumns) {
    for (int c = 0; c < kTileColumns; ++c, target += stride) {
      lanes(target).all -= sums[c][0];
      lanes(target + 4).all -= sums[c][1];
    }
  } else {
    for (int c = 0; c < columns; ++c, target += stride) {
      for (int r = 0; r < rows; ++r) target[r] -= sums[c][r / 4][r % 4];
    }
  }
}

DenseLdl::DenseLdl(int size) {
  // Strips restart below the eliminated columns.
  const std::size_t strips = size / kTileRows + 2;
  strips_.resize(strips);
  left_.resize(strips * kTileRows * kBlock);
  right_.resize(left_.size());
  square_.resize(kBlock * kBlock);
}

bool DenseLdl::eliminate(double* panel, int rows, int columns, double* update, const double* scale,
                         double* d, Pivots& pivots) noexcept {
  for (int begin = 0; begin < columns; begin += kBlock) {
    const int width = std::min(kBlock, columns - begin), end = begin + width;
    double* block = panel + static_cast<std::ptrdiff_t>(begin) * rows;
    if (!factor_block(block + begin, rows, width, scale + begin, d + begin, pivots)) return false;
    const int count = pack(block, rows, end, columns, width, d + begin);
    for (int i = 0; i < count; ++i) {
      const Strip& down = strips_[i];
      for (int j = 0; j <= i; ++j) {
        for (int part = 0; part < kTileRows; part += kTileColumns) {
          const int across = std::min(kTileColumns, strips_[j].height - part);
          if (across <= 0) break;
          const int column = strips_[j].row + part;
          const std::ptrdiff_t stride = column < columns ? rows : rows - columns;
          double* target = column < columns
                               ? panel + column * stride + down.row
                               : update + (column - columns) * stride + (down.row - columns);
          subtract_product(&left_[i * kTileRows * kBlock],
                           &right_[(2 * j + part / kTileColumns) * kTileColumns * kBlock], width,
                           down.height, across, target, stride);
        }
      }
    }
  }
  return true;
}

/// Factors the square at the top of a block.
bool DenseLdl::factor_block(double* block, int rows, int width, const double* scale, double* d,
                            Pivots& pivots) noexcept {
  for (int j = 0; j < width; ++j) {
    double* column = block + static_cast<std::ptrdiff_t>(j) * rows;
    const double pivot = column[j];
    if (!(std::abs(pivot) > kZero * scale[j]) || !std::isfinite(pivot)) return false;
    if (pivot < 0) ++pivots.negative;
    pivots.smallest = std::min(pivots.smallest, pivot / scale[j]);
    d[j] = pivot;
    for (int k = j + 1; k < width; ++k) {
      const double factor = column[k] / pivot;
      double* target = block + static_cast<std::ptrdiff_t>(k) * rows;
      for (int i = k; i < width; ++i) target[i] -= factor * column[i];
    }
    for (int i = j + 1; i < width; ++i) column[i] /= pivot;
  }
  return true;
}

/// Solves for the rows below the square, strip by strip, and packs them; returns the number of
/// strips.
int DenseLdl::pack(double* block, int rows, int from, int columns, int width,
                   const double* d) noexcept {
  const double* square = block + (from - width);
  double inverse[kBlock];
  for (int j = 0; j < width; ++j) inverse[j] = 1 / d[j];
  // The square as right factor of the tile products, without its diagonal tiles.
  for (int g = kTileColumns; g < width; g += kTileColumns) {
    double* target = &square_[g * kBlock];
    for (int k = 0; k < g; ++k, target += kTileColumns) {
      const double* source = square + static_cast<std::ptrdiff_t>(k) * rows + g;
      for (int c = 0; c < kTileColumns; ++c) target[c] = g + c < width ? source[c] : 0;
    }
  }
  int count = 0;
  for (int row = from; row < rows; ++count) {
    const int height = std::min(kTileRows, (row < columns ? columns : rows) - row);
    strips_[count] = {row, height};
    double* strip = &left_[count * kTileRows * kBlock];
    for (int j = 0; j < width; ++j) {
      const double* source = block + static_cast<std::ptrdiff_t>(j) * rows + row;
      double* target = strip + j * kTileRows;
      if (height == kTileRows) {
        lanes(target).all = lanes(source).all;
        lanes(target + 4).all = lanes(source + 4).all;
      } else {
        for (int r = 0; r < kTileRows; ++r) target[r] = r < height ? source[r] : 0;
      }
    }
    for (int g = 0; g < width; g += kTileColumns) {
      const int end = std::min(g + kTileColumns, width);
      double* own = strip + g * kTileRows;
      subtract_product(strip, &square_[g * kBlock], g, kTileRows, end - g, own, kTileRows);
      for (int k = g; k < end; ++k, own += kTileRows) {
        const Lanes low = lanes(own).all, high = lanes(own + 4).all;
        const double* below = square + static_cast<std::ptrdiff_t>(k) * rows;
        for (int j = k + 1; j < end; ++j) {
          double* target = strip + j * kTileRows;
          lanes(target).all -= low * below[j];
          lanes(target + 4).all -= high * below[j];
        }
      }
    }
    double* right = &right_[count * kTileRows * kBlock];
    for (int j = 0; j < width; ++j, right += kTileColumns) {
      double* source = strip + j * kTileRows;
      const Lanes low = lanes(source).all, high = lanes(source + 4).all;
      lanes(right).all = low;
      lanes(right + kTileColumns * kBlock).all = high;
      lanes(source).all = low * inverse[j];
      lanes(source + 4).all = high * inverse[j];
      double* target = block + static_cast<std::ptrdiff_t>(j) * rows + row;
      if (height == kTileRows) {
        lanes(target).all = lanes(source).all;
        lanes(target + 4).all = lanes(source + 4).all;
      } else {
        for (int r = 0; r < height; ++r) target[r] = source[r];
      }
    }
    row += height;
  }
  return count;
}

}  // namespace palpate::factor
