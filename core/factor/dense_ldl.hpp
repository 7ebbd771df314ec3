#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace palpate::factor {

/// Pivots of a factorisation, as information on its matrix.
struct Pivots {
  int negative = 0;  // number of negative pivots, which equals that of negative eigenvalues
  /// Smallest ratio of pivot to the corresponding diagonal entry of the matrix, signed: near 0 the
  /// matrix is close to losing definiteness.
  double smallest = std::numeric_limits<double>::infinity();

  void add(const Pivots& other) {
    negative += other.negative;
    smallest = std::min(smallest, other.smallest);
  }
};

/// Rows and columns of a tile of the product below.
inline constexpr int kTileRows = 8, kTileColumns = 4;

/// target -= a b^T for the first `rows` rows and the columns of a tile. Entry (r, k) of a is at k *
/// kTileRows + r, entry (c, k) of b at k * kTileColumns + c, both padded to whole tiles; entry (r,
/// c) of the target is at c * stride + r.
void subtract_product(const double* a, const double* b, int depth, int rows, int columns,
                      double* target, std::ptrdiff_t stride) noexcept;

/// Eliminates the first columns of a dense symmetric matrix without pivoting, A = L D L^T, in
/// double precision. Contains the workspace: not thread-safe; nothing allocates after construction.
class DenseLdl {
 public:
  /// `size`: rows of the largest matrix.
  explicit DenseLdl(int size);

  /// panel: the first `columns` columns of the matrix, each of length `rows`; update: the lower
  /// half of the other columns, (rows - columns)^2. On return panel contains L (its unit diagonal
  /// and the part above are undefined), d the pivots, update the Schur complement. `scale`:
  /// magnitude of the matrix entries in each column. False, with undefined results, if a pivot
  /// vanishes compared with `scale` to within rounding, or is not finite.
  bool eliminate(double* panel, int rows, int columns, double* update, const double* scale,
                 double* d, Pivots& pivots) noexcept;

 private:
  struct Strip {
    int row, height;
  };

  bool factor_block(double* block, int rows, int width, const double* scale, double* d,
                    Pivots& pivots) noexcept;
  int pack(double* block, int rows, int from, int columns, int width, const double* d) noexcept;

  std::vector<Strip> strips_;
  std::vector<double> left_, right_;  // L and L D of the rows below a block, in tiles
  std::vector<double> square_;        // L of a block
};

}  // namespace palpate::factor
