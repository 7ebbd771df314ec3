#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace palpate::factor {

/// What the pivots of a factor say about its matrix.
struct Pivots {
  int negative = 0;  // as many as negative eigenvalues
  /// The smallest over the diagonal entry of the matrix that it came from, signed: near 0 the
  /// matrix is close to losing definiteness.
  double smallest = std::numeric_limits<double>::infinity();

  void add(const Pivots& other) {
    negative += other.negative;
    smallest = std::min(smallest, other.smallest);
  }
};

/// Rows and columns of a tile of the product below.
inline constexpr int kTileRows = 8, kTileColumns = 4;

/// target -= a b^T for the first rows and columns of a tile. a's entry (r, k) is at
/// k * kTileRows + r, b's entry (c, k) at k * kTileColumns + c, both whole tiles; the target's
/// entry (r, c) at c * stride + r.
void subtract_product(const double* a, const double* b, int depth, int rows, int columns,
                      double* target, std::ptrdiff_t stride) noexcept;

/// Eliminates the first columns of a dense symmetric matrix without pivoting, A = L D L^T, in
/// double. Holds the work space: one thread at a time, nothing allocates after construction.
class DenseLdl {
 public:
  /// `size`: rows of the largest matrix.
  explicit DenseLdl(int size);

  /// panel: the first `columns` columns of the matrix, `rows` long each; update: the lower half of
  /// the other columns, (rows - columns)^2. Panel becomes L (its unit diagonal and what is above
  /// are not written sensibly), d the pivots, update the Schur complement. `scale`: size of the
  /// matrix' entries in each column; false, with everything in pieces, where a pivot vanishes
  /// beside it to rounding or is not finite.
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
