#include "core/elasticity/dense_ldl.hpp"

#include <cmath>

namespace palpate::elasticity {
namespace {

constexpr int kBlock = 32;       // columns eliminated at once
constexpr double kZero = 1e-11;  // of the scale: rounding leaves less of a pivot that vanishes

// Four doubles in a register where there are such, in two or four where not.
using Lanes = double __attribute__((vector_size(32)));
using Unaligned = Lanes __attribute__((aligned(8), may_alias));

Unaligned& lanes(double* p) { return *reinterpret_cast<Unaligned*>(p); }
const Unaligned& lanes(const double* p) { return *reinterpret_cast<const Unaligned*>(p); }

}  // namespace

void tile_product(const double* a, const double* b, int depth, double* product) noexcept {
  Lanes sums[kTileColumns][2];
  for (int c = 0; c < kTileColumns; ++c) sums[c][0] = sums[c][1] = Lanes{};
  for (int k = 0; k < depth; ++k, a += kTileRows, b += kTileColumns) {
    const Lanes low = lanes(a), high = lanes(a + 4);
    for (int c = 0; c < kTileColumns; ++c) {
      sums[c][0] += low * b[c];
      sums[c][1] += high * b[c];
    }
  }
  for (int c = 0; c < kTileColumns; ++c, product += kTileRows) {
    lanes(product) = sums[c][0];
    lanes(product + 4) = sums[c][1];
  }
}

DenseLdl::DenseLdl(int size) {
  // Strips begin anew below the eliminated columns.
  const std::size_t strips = size / kTileRows + 2;
  strips_.resize(strips);
  left_.resize(strips * kTileRows * kBlock);
  right_.resize(left_.size());
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
          double product[kTileRows * kTileColumns];
          tile_product(&left_[i * kTileRows * kBlock],
                       &right_[(2 * j + part / kTileColumns) * kTileColumns * kBlock], width,
                       product);
          const int column = strips_[j].row + part;
          const int ld = column < columns ? rows : rows - columns;
          double* target = column < columns
                               ? panel + static_cast<std::ptrdiff_t>(column) * rows + down.row
                               : update + static_cast<std::ptrdiff_t>(column - columns) * ld +
                                     (down.row - columns);
          for (int c = 0; c < across; ++c, target += ld) {
            const double* p = product + c * kTileRows;
            if (down.height == kTileRows) {
              for (int r = 0; r < kTileRows; ++r) target[r] -= p[r];
            } else {
              for (int r = 0; r < down.height; ++r) target[r] -= p[r];
            }
          }
        }
      }
    }
  }
  return true;
}

/// The square at the top of a block.
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

/// Solves for the rows below the square, strip by strip, and packs them; number of strips.
int DenseLdl::pack(double* block, int rows, int from, int columns, int width,
                   const double* d) noexcept {
  int count = 0;
  const double* square = block + (from - width);
  double inverse[kBlock];
  for (int j = 0; j < width; ++j) inverse[j] = 1 / d[j];
  for (int row = from; row < rows; ++count) {
    const int height = std::min(kTileRows, (row < columns ? columns : rows) - row);
    strips_[count] = {row, height};
    double* strip = &left_[count * kTileRows * kBlock];
    for (int j = 0; j < width; ++j) {
      const double* source = block + static_cast<std::ptrdiff_t>(j) * rows + row;
      double* target = strip + j * kTileRows;
      for (int r = 0; r < height; ++r) target[r] = source[r];
      for (int r = height; r < kTileRows; ++r) target[r] = 0;
    }
    for (int k = 0; k < width; ++k) {
      const Lanes low = lanes(strip + k * kTileRows), high = lanes(strip + k * kTileRows + 4);
      const double* below = square + static_cast<std::ptrdiff_t>(k) * rows;
      for (int j = k + 1; j < width; ++j) {
        double* target = strip + j * kTileRows;
        lanes(target) -= low * below[j];
        lanes(target + 4) -= high * below[j];
      }
    }
    double* right = &right_[count * kTileRows * kBlock];
    for (int j = 0; j < width; ++j) {
      double* source = strip + j * kTileRows;
      for (int r = 0; r < kTileRows; ++r) {
        right[(r / kTileColumns) * kTileColumns * kBlock + j * kTileColumns + r % kTileColumns] =
            source[r];
        source[r] *= inverse[j];
      }
      double* target = block + static_cast<std::ptrdiff_t>(j) * rows + row;
      for (int r = 0; r < height; ++r) target[r] = source[r];
    }
    row += height;
  }
  return count;
}

}  // namespace palpate::elasticity
