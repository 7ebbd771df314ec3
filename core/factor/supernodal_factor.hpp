#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "core/factor/supernodes.hpp"

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

/// A = L D L^T in double precision, multifrontal, without pivoting. The interior is factored once;
/// the Schur complement of the border is factored for each set of grasp patches that may be held,
/// so that one factor serves all of them. Contains the workspace: not thread-safe; nothing
/// allocates after construction. Derived classes compute the same factor in another way.
class SupernodalFactor {
 public:
  /// `supernodes` must outlive the factor.
  explicit SupernodalFactor(const Supernodes& supernodes);
  explicit SupernodalFactor(Supernodes&&) = delete;
  virtual ~SupernodalFactor() = default;

  const Supernodes& supernodes() const { return *supernodes_; }

  /// `shift` (N/m) is added to the diagonal. False if a pivot of the interior vanishes to rounding:
  /// the matrix is singular and the factor must not be used.
  virtual bool factorise(const BlockMatrix& A, double shift = 0) noexcept;

  /// Whether solve() is available with these groups held; false if the free part of the border is
  /// singular to rounding.
  bool is_regular(Held held) const { return interior_regular_ && border(held).regular; }
  /// Pivots of interior and free border groups.
  Pivots pivots(Held held) const;
  bool is_positive(Held held) const { return is_regular(held) && pivots(held).negative == 0; }
  bool is_interior_positive() const { return interior_regular_ && interior_.negative == 0; }

  /// Overwrites the columns of B (3 size() x k, in elimination order, the axes of an unknown
  /// adjacent) with A^-1 B. Rows of held groups are not read and become zero. Requires
  /// is_regular().
  void solve(Eigen::Ref<Eigen::MatrixXd> B, Held held) const noexcept;

  /// Panel of supernode s: columns of L, column-major, each of length 3 (columns + rows); the
  /// diagonal and the part above it are to be taken as 1 and 0.
  const double* panel(int s) const { return panels_.data() + panel_start_[s]; }
  const std::vector<double>& d() const { return d_; }  // length 3 interior_size()
  // diagonal of A + shift, length 3 size()
  const std::vector<double>& diagonal() const { return diagonal_; }

  /// Inverse of the Schur complement over the rows of the free groups, row and column 0 being the
  /// first free unknown; both triangles, column-major, written to `inverse`. Requires is_regular().
  void invert_border(Held held, double* inverse) const noexcept;

 protected:
  /// Storage for factorise() of a derived class, and its first and last steps.
  struct Storage {
    double* panels;  // one supernode after the other, as panel() describes
    double* d;
    const double* scale;  // N/m, magnitude of the matrix around each diagonal entry
    double* schur;  // Schur complement of the whole border, column-major; its lower half is read
  };
  /// Sets diagonal() and `scale` from a matrix; the factor is not to be used until finish().
  Storage begin(const BlockMatrix& A, double shift) noexcept;
  /// Declares L, `d` and `schur` complete and factors the border. `interior`: the pivots `d`.
  void finish(const Pivots& interior) noexcept;
  /// Adds room for `size` numbers behind the panels, which may move.
  void extend_panels(std::ptrdiff_t size) { panels_.resize(panels_.size() + size); }

 private:
  struct Border {
    int offset = 0, size = 0;  // scalars
    bool regular = false;
    Pivots pivots;
    std::vector<double> lower, d;
  };

  /// Matrix under elimination: `columns` and `rows` unknowns; panel length 3 (columns + rows).
  struct Front {
    double *panel, *update;
    int columns, rows;
  };

  Border& border(Held held) { return borders_[supernodes_->pattern().held_set(held)]; }
  const Border& border(Held held) const { return borders_[supernodes_->pattern().held_set(held)]; }
  static void clear(const Front& front) noexcept;
  void assemble(const BlockMatrix& A, int first, const Front& front) noexcept;
  void gather(const std::vector<int>& children, double*& top, const Front& front) noexcept;
  void factorise_border(Border& border) noexcept;
  template <int kPacks>
  void solve_lanes(Eigen::Ref<Eigen::MatrixXd> B, Held held) const noexcept;

  const Supernodes* supernodes_;
  std::vector<std::ptrdiff_t> panel_start_;
  std::vector<double> panels_, d_, diagonal_, scale_;
  bool interior_regular_ = false;
  Pivots interior_;
  std::vector<double> schur_;  // lower half, over all groups
  std::array<Border, 4> borders_;
  DenseLdl dense_;

  // Updates wait for their parent on two stacks, selected by the parity of their depth in the tree:
  // those of a supernode's children lie on top of one stack while its own is pushed onto the other.
  std::vector<int> depth_;
  std::array<std::vector<double>, 2> stacks_;
  std::vector<std::vector<int>> children_;  // children of each supernode, and of the border
  std::vector<int> local_;                  // by unknown: its position in the present front
  // Workspace: row positions of a child or a panel; right-hand sides, row by row.
  mutable std::vector<int> targets_;
  mutable std::vector<double> lanes_;
};

/// Creates a factor for these supernodes, which must outlive it.
using FactorMaker = std::unique_ptr<SupernodalFactor> (*)(const Supernodes& supernodes);

/// palpate's own L D L^T; the alternative is core/factor/cholmod/cholmod_factor.hpp.
inline std::unique_ptr<SupernodalFactor> make_own_factor(const Supernodes& supernodes) {
  return std::make_unique<SupernodalFactor>(supernodes);
}

}  // namespace palpate::factor
