#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/factor/supernodal_factor.hpp"
#include "core/factor/supernodes.hpp"
#include "core/math/team.hpp"

namespace palpate::factor {

/// Elimination tree partitioned among the members of a team. Subtrees are independent in a solve,
/// but contribute to the supernodes above them.
struct TreeShares {
  /// Supernodes of a subtree: a contiguous range, because they are in postorder.
  struct Range {
    int begin, end;
  };
  /// Supernode above all subtrees.
  struct Top {
    int node;
    bool is_shared;  // large enough to be shared by all members
  };
  std::vector<std::vector<Range>> members;  // ascending
  std::vector<Top> top;                     // ascending
};

/// Partition that minimises the estimated completion time, from the costs of the panels.
/// Deterministic. A single member receives the whole tree.
TreeShares share_tree(const Supernodes& nodes, int members);

/// Storage precision of panels; arithmetic is in single precision. Half precision (where the
/// processor can convert it, else identical to single) halves the memory traffic, which dominates
/// the time of a solve, at a relative error of about 1e-4.
enum class PanelPrecision { kSingle, kHalf };

/// Solver of the 1 kHz loop: the partitioned inverse of a positive definite factor. With C C^T = D
/// A D, D_ii = 1 / sqrt(A_ii), each supernode has one panel P = [inv(C11); -C21 inv(C11)], so that
/// both substitutions are matrix-vector products that read memory once, sequentially: forward (z1;
/// delta) = P b1, backward x1 = P^T (z1; x_rows). The free part of the border is solved with the
/// explicit inverse of its Schur complement. Each member of a team processes its own subtrees and a
/// part of the rows of each large panel above them; the calling thread does the rest.
class SolvePanels {
 public:
  /// `team` must outlive this object and is used by solve() only. Its size determines the summation
  /// order.
  SolvePanels(const Supernodes& supernodes, PanelPrecision precision,
              math::Team& team = math::solo_team);

  /// Assigns a factor of these supernodes. False if it cannot be used for any set of held groups:
  /// the interior is not positive definite, or too close to singular for the precision. If only the
  /// free part of the border is indefinite, it is made positive definite, so that solutions are
  /// descent directions; only this case allocates.
  bool assign(const SupernodalFactor& factor) noexcept;

  /// Whether solve() is available with these groups held.
  bool usable(Held held) const noexcept { return border(held).usable; }

  /// b: 3 size() numbers in elimination order, the axes of an unknown adjacent; overwritten with
  /// A^-1 b. Rows of held groups are not read and become zero. Requires usable(held).
  void solve(float* b, Held held) noexcept;

  std::size_t bytes() const { return size_; }  // total size of all panels

 private:
  /// Dense part of a panel: tiles of 8 rows, `height` of them interleaved, column by column.
  struct Rectangle {
    int tile, height, begin, end;
    std::size_t offset;  // bytes
  };
  /// Consecutive unknowns among a panel's rows, in scalars.
  struct Run {
    int target, count;
  };
  /// The rows of a panel are ordered: interior, group 0, group 1.
  static constexpr int kLevels = 3;
  struct Panel {
    int first, columns, rectangles, runs;
    std::array<int, kLevels> rows, rectangles_end, runs_end;
  };
  struct Border {
    bool usable = false;
    int offset = 0, size = 0;    // scalars
    std::vector<float> inverse;  // scaled like the panels, in tiles
  };
  /// Consecutive panels and their rows of b.
  struct Span {
    int panels_begin, panels_end, begin, end;
  };
  /// Work and workspace of one member.
  struct Desk {
    std::vector<Span> spans;  // subtrees
    std::vector<float> rows, sums;
    std::vector<float> vector;  // used instead of b by all but the first member
  };
  /// Panel above all subtrees, and the starts of the members' rectangles if they share it.
  struct Top {
    Span span;
    std::vector<int> shares;
  };
  struct Free {
    void operator()(std::byte* memory) const noexcept;
  };

  Border& border(Held held) { return borders_[pattern_->held_set(held)]; }
  const Border& border(Held held) const { return borders_[pattern_->held_set(held)]; }
  void lay_out(const Supernodes& supernodes);
  template <class Stored>
  bool store(const Panel& panel) noexcept;
  void invert(const SupernodalFactor& factor, int s, const Panel& panel) noexcept;
  void assign_border(const SupernodalFactor& factor, Held held) noexcept;
  Span span(int panels_begin, int panels_end) const;
  void share_out(const TreeShares& shares);
  std::vector<int> split(const Panel& panel) const;
  template <class Stored>
  const Stored* stored(const Rectangle& rectangle) const noexcept {
    return reinterpret_cast<const Stored*>(memory_.get() + rectangle.offset);
  }
  void scale(const Span& rows, const float* from, float* to) const noexcept;
  template <class Stored>
  void sweep(float* b, Held held) noexcept;
  template <class Stored>
  void multiply_rows(int begin, int end, const float* b, float* rows) const noexcept;
  template <class Stored>
  void multiply_columns(int begin, int end, const float* rows, int columns,
                        float* sums) const noexcept;
  void scatter(const Panel& panel, int level, const float* rows, float* b) const noexcept;
  void gather(const Panel& panel, int level, const float* b, float* rows) const noexcept;
  template <class Stored>
  void sweep_up(const Span& span, int level, float* b, Desk& desk) const noexcept;
  template <class Stored>
  void sweep_down(const Span& span, int level, float* b, Desk& desk) const noexcept;
  template <class Stored>
  void sweep_up_together(const Top& top, int level, float* b) noexcept;
  template <class Stored>
  void sweep_down_together(const Top& top, int level, float* b) noexcept;
  void solve_border(float* b, const Border& border) noexcept;

  math::Team* team_;
  const BlockPattern* pattern_;
  bool half_;
  int size_of_b_, interior_;  // scalars
  std::vector<Panel> panels_;
  std::vector<Rectangle> rectangles_;
  std::vector<Run> runs_;
  std::size_t size_ = 0;
  std::unique_ptr<std::byte[], Free> memory_;
  std::vector<float> scaling_;  // diagonal of D
  std::array<Border, 4> borders_;
  std::vector<Desk> desks_;
  std::vector<Top> top_;  // the border, which has no panels, comes last
  // Workspace of assign().
  std::vector<float> rows_;
  std::vector<double> dense_, left_, right_;
};

}  // namespace palpate::factor
