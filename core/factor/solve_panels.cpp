#include "core/factor/solve_panels.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>

#include "core/factor/panel_kernel.hpp"
#include "core/math/pack.hpp"

namespace palpate::factor {
namespace {

using Range = TreeShares::Range;

/// Cost of synchronising all members for a panel, twice per solve, in the unit of panel costs: two
/// or three microseconds.
constexpr double kTogether = 25000;
/// Maximum number of subtrees evaluated per member.
constexpr int kSubtreesPerMember = 12;

struct Tree {
  explicit Tree(const Supernodes& nodes)
      : cost(nodes.count()), first(nodes.count()), children(nodes.count() + 1) {
    std::iota(first.begin(), first.end(), 0);
    for (int s = 0; s < nodes.count(); ++s) {
      const int parent = nodes.parent(s);
      cost[s] += nodes.cost(s);
      children[parent].push_back(s);
      if (parent == nodes.count()) continue;
      cost[parent] += cost[s];
      first[parent] = std::min(first[parent], first[s]);
    }
  }

  std::vector<double> cost;                // cost of the subtree
  std::vector<int> first;                  // first supernode of the subtree
  std::vector<std::vector<int>> children;  // last entry: the roots
};

/// Assigns the largest subtree first, each to the member with the least work. Returns the work of
/// the busiest member.
double deal(const Tree& tree, std::vector<int> roots, std::vector<std::vector<Range>>& members) {
  std::sort(roots.begin(), roots.end(), [&tree](int a, int b) {
    return tree.cost[a] != tree.cost[b] ? tree.cost[a] > tree.cost[b] : a < b;
  });
  std::vector<double> load(members.size());
  for (int s : roots) {
    const auto least = std::min_element(load.begin(), load.end()) - load.begin();
    load[least] += tree.cost[s];
    members[least].push_back({tree.first[s], s + 1});
  }
  return *std::max_element(load.begin(), load.end());
}

double cost_together(double cost, int members) { return cost / members + kTogether; }

using panel_kernel::kGroup;
using panel_kernel::kTile;
using panel_kernel::padded;
using panel_kernel::tiles_of;
constexpr std::align_val_t kAlignment{64};
static_assert(kTile == kTileRows);

/// Replaces the eigenvalues of a symmetric matrix by their absolute values, limited to the largest
/// positive one: releasing a grasp leaves a stressed, unstable object, and corrections must be
/// descent directions until a new factor is available.
void make_positive(double* a, int size) {
  Eigen::Map<Eigen::MatrixXd> A(a, size, size);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  const Eigen::VectorXd& values = eigen.eigenvalues();
  const double largest = std::max(values(size - 1), 1.0);  // eigenvalues of a scaled matrix
  A = eigen.eigenvectors() * values.cwiseAbs().cwiseMin(largest).asDiagonal() *
      eigen.eigenvectors().transpose();
}

}  // namespace

TreeShares share_tree(const Supernodes& nodes, int members) {
  TreeShares best;
  if (members == 1) {
    best.members = {{{0, nodes.count()}}};
    return best;
  }
  const Tree tree(nodes);
  std::vector<int> roots = tree.children.back();
  std::vector<TreeShares::Top> top;
  double top_cost = 0, least = -1;
  // Split the most expensive subtree at its root until this no longer helps.
  for (;;) {
    std::vector<std::vector<Range>> dealt(members);
    const double time = deal(tree, roots, dealt) + top_cost;
    if (least < 0 || time < least) {
      least = time;
      best = {std::move(dealt), top};
    }
    const auto largest = std::max_element(
        roots.begin(), roots.end(), [&tree](int a, int b) { return tree.cost[a] < tree.cost[b]; });
    if (largest == roots.end() || static_cast<int>(roots.size()) > kSubtreesPerMember * members) {
      break;
    }
    const int s = *largest;
    roots.erase(largest);
    const double alone = nodes.cost(s), together = cost_together(alone, members);
    top.push_back({s, together < alone});
    top_cost += std::min(alone, together);
    roots.insert(roots.end(), tree.children[s].begin(), tree.children[s].end());
  }
  for (std::vector<Range>& ranges : best.members) {
    std::sort(ranges.begin(), ranges.end(),
              [](const Range& a, const Range& b) { return a.begin < b.begin; });
  }
  std::sort(best.top.begin(), best.top.end(),
            [](const TreeShares::Top& a, const TreeShares::Top& b) { return a.node < b.node; });
  return best;
}

void SolvePanels::Free::operator()(std::byte* memory) const noexcept {
  ::operator delete[](memory, kAlignment);
}

SolvePanels::SolvePanels(const Supernodes& supernodes, PanelPrecision precision, math::Team& team)
    : team_(&team),
      pattern_(&supernodes.pattern()),
      half_(precision == PanelPrecision::kHalf && panel_kernel::kHasHalf),
      size_of_b_(3 * supernodes.pattern().size()),
      interior_(3 * supernodes.pattern().interior_size()),
      scaling_(size_of_b_) {
  lay_out(supernodes);
  share_out(share_tree(supernodes, team.size()));
  memory_.reset(new (kAlignment) std::byte[size_ + 64]);

  const BlockPattern& pattern = supernodes.pattern();
  for (int set = 0; set < 4; ++set) {
    const Held held{(set & 1) != 0, (set & 2) != 0};
    if (pattern.held_set(held) != set) continue;
    const int begin = held[0] ? pattern.border_begin(1) : pattern.border_begin(0);
    const int end = held[1] ? pattern.border_end(0) : pattern.border_end(1);
    Border& b = border(held);
    b.offset = 3 * begin;
    b.size = 3 * std::max(0, end - begin);
    b.inverse.resize(static_cast<std::size_t>(padded(b.size)) * b.size);
  }
  const int border_size = size_of_b_ - interior_;
  int rows = border_size, columns = 0;
  std::size_t entries = static_cast<std::size_t>(border_size) * border_size, square = 0;
  for (const Panel& panel : panels_) {
    rows = std::max(rows, panel.rows.back());
    columns = std::max(columns, panel.columns);
    entries =
        std::max(entries, static_cast<std::size_t>(padded(panel.rows.back())) * panel.columns);
    square =
        std::max(square, static_cast<std::size_t>(panel.columns) * (panel.columns + kTileColumns));
  }
  rows_.resize(padded(rows));
  for (Desk& desk : desks_) {
    desk.rows.resize(padded(rows));
    desk.sums.resize((columns + kTile) * kTile);
    if (desks_.size() > 1) desk.vector.resize(size_of_b_);
  }
  dense_.resize(entries);
  left_.resize(entries);
  right_.resize(square);
}

void SolvePanels::lay_out(const Supernodes& nodes) {
  const BlockPattern& pattern = nodes.pattern();
  const std::size_t stored = half_ ? sizeof(std::uint16_t) : sizeof(float);
  for (int s = 0; s < nodes.count(); ++s) {
    Panel panel{};
    panel.first = 3 * nodes.begin(s);
    panel.columns = 3 * nodes.columns(s);
    panel.rectangles = static_cast<int>(rectangles_.size());
    panel.runs = static_cast<int>(runs_.size());
    const int* row = nodes.rows_begin(s);
    int tile = 0, rows = panel.columns;
    for (int level = 0; level < kLevels; ++level) {
      // range of rows
      const int end = level == 0 ? pattern.interior_size() : pattern.border_end(level - 1);
      for (bool first = true; row != nodes.rows_end(s) && *row < end; ++row, first = false) {
        rows += 3;
        if (!first && row[-1] + 1 == *row) {
          runs_.back().count += 3;
        } else {
          runs_.push_back({3 * *row, 3});
        }
      }
      panel.rows[level] = rows;
      panel.runs_end[level] = static_cast<int>(runs_.size());
      // their tiles without those above the diagonal: a staircase of rectangles
      const int tiles = tiles_of(rows);
      while (tile < tiles) {
        const int height = std::min(kGroup, tiles - tile);
        for (int h = 0, begin = 0; h < height && begin < panel.columns; ++h) {
          const int last = (tile + h + 1) * kTile;
          const int columns_end = std::min(panel.columns, last);
          rectangles_.push_back({tile + h, height - h, begin, columns_end, size_});
          size_ += stored * (height - h) * kTile * (columns_end - begin);
          begin = columns_end;
        }
        tile += height;
      }
      panel.rectangles_end[level] = static_cast<int>(rectangles_.size());
    }
    panels_.push_back(panel);
  }
}

bool SolvePanels::assign(const SupernodalFactor& factor) noexcept {
  for (Border& border : borders_) border.usable = false;
  if (!factor.is_interior_positive()) return false;
  for (int i = 0; i < size_of_b_; ++i) {
    const double a = factor.diagonal()[i];
    scaling_[i] = a > 0 ? static_cast<float>(1 / std::sqrt(a)) : 1.0f;
  }
  for (std::size_t s = 0; s < panels_.size(); ++s) {
    invert(factor, static_cast<int>(s), panels_[s]);
#if PALPATE_HAS_HALF
    if (!(half_ ? store<std::uint16_t>(panels_[s]) : store<float>(panels_[s]))) return false;
#else
    if (!store<float>(panels_[s])) return false;
#endif
  }
  bool any = false;
  for (int set = 0; set < 4; ++set) {
    const Held held{(set & 1) != 0, (set & 2) != 0};
    if (pattern_->held_set(held) != set || !factor.is_regular(held)) continue;
    assign_border(factor, held);
    any = border(held).usable = true;
  }
  return any;
}

/// Computes a panel in double precision, without D, into left_: tile by tile of kTileRows rows,
/// column by column. Tiles above the diagonal are not written. The row scales go to dense_.
void SolvePanels::invert(const SupernodalFactor& factor, int s, const Panel& panel) noexcept {
  const int columns = panel.columns, rows = panel.rows.back();
  const double* lower = factor.panel(s);
  const auto l = [&](int row, int column) {
    return lower[static_cast<std::ptrdiff_t>(column) * rows + row];
  };
  // X = [inv(L11); -L21 inv(L11)] solves X L11 = [1; -L21]: from the last columns to the first, in
  // groups of four; each group subtracts the product of the columns behind it with their rows of
  // L11.
  for (int g = 0; g + kTileColumns < columns; g += kTileColumns) {
    double* target = &right_[g * columns];
    for (int k = g + kTileColumns; k < columns; ++k) {
      for (int c = 0; c < kTileColumns; ++c) target[k * kTileColumns + c] = l(k, g + c);
    }
  }
  for (int first = 0; first < rows; first += kTileRows) {
    const int end = std::min(columns, first + kTileRows);  // the remainder is zero
    double* x = &left_[static_cast<std::ptrdiff_t>(first) * columns];
    const bool is_below = first >= columns && first + kTileRows <= rows;
    for (int c = 0; c < end; ++c) {
      double* target = x + c * kTileRows;
      const double* source = lower + static_cast<std::ptrdiff_t>(c) * rows + first;
      for (int r = 0; r < kTileRows; ++r) {
        if (is_below) {
          target[r] = -source[r];
        } else {
          const int row = first + r;
          target[r] = row >= rows ? 0 : row >= columns ? -source[r] : row == c ? 1 : 0;
        }
      }
    }
    for (int g = (end - 1) / kTileColumns * kTileColumns; g >= 0; g -= kTileColumns) {
      const int width = std::min(kTileColumns, columns - g), behind = g + width;
      double* own = x + g * kTileRows;
      subtract_product(x + behind * kTileRows, &right_[g * columns + behind * kTileColumns],
                       end - behind, kTileRows, width, own, kTileRows);
      for (int k = width - 1; k > 0; --k) {
        const double* known = own + k * kTileRows;
        const math::Pack4d low = math::load(known), high = math::load(known + 4);
        for (int c = 0; c < k; ++c) {
          double* target = own + c * kTileRows;
          math::store(math::load(target) - l(g + k, g + c) * low, target);
          math::store(math::load(target + 4) - l(g + k, g + c) * high, target + 4);
        }
      }
    }
  }

  double* scale = dense_.data();
  for (int k = 0; k < columns; ++k) *scale++ = 1 / std::sqrt(factor.d()[panel.first + k]);
  for (int r = panel.runs; r < panel.runs_end.back(); ++r) {
    for (int k = 0; k < runs_[r].count; ++k) {
      *scale++ = static_cast<double>(scaling_[runs_[r].target + k]);
    }
  }
  std::fill(scale, dense_.data() + tiles_of(rows) * kTile, 0.0);
}

/// Converts left_, scaled, to the layout of the sweeps; false if a number is too large.
template <class Stored>
bool SolvePanels::store(const Panel& panel) noexcept {
  const float limit = sizeof(Stored) == sizeof(float) ? 1e30f : 6e4f;
  panel_kernel::Lanes lanes, largest{};
  for (int k = panel.rectangles; k < panel.rectangles_end.back(); ++k) {
    const Rectangle& rectangle = rectangles_[k];
    Stored* target = reinterpret_cast<Stored*>(memory_.get() + rectangle.offset);
    for (int c = rectangle.begin; c < rectangle.end; ++c) {
      const double own = 1 / static_cast<double>(scaling_[panel.first + c]);
      for (int h = 0; h < rectangle.height; ++h, target += kTile) {
        const std::ptrdiff_t tile = rectangle.tile + h;
        const double* source = &left_[(tile * panel.columns + c) * kTile];
        const double* scale = &dense_[tile * kTile];
        float numbers[kTile];
        for (int r = 0; r < kTile; ++r) numbers[r] = static_cast<float>(source[r] * own * scale[r]);
        panel_kernel::load(numbers, lanes);
        panel_kernel::encode(lanes, target);
        lanes = lanes < 0 ? -lanes : lanes;
        largest = lanes > largest ? lanes : largest;
      }
    }
  }
  for (int r = 0; r < kTile; ++r) {
    if (largest[r] >= limit) return false;
  }
  return true;
}

void SolvePanels::assign_border(const SupernodalFactor& factor, Held held) noexcept {
  Border& b = border(held);
  factor.invert_border(held, dense_.data());
  // Groups of tiles: row i of column c of a group at c * kGroup * kTile + i.
  std::fill(b.inverse.begin(), b.inverse.end(), 0.0f);
  for (int i = 0; i < b.size; ++i) left_[i] = 1 / static_cast<double>(scaling_[b.offset + i]);
  for (int c = 0; c < b.size; ++c) {
    for (int i = 0; i < b.size; ++i) {
      dense_[static_cast<std::size_t>(c) * b.size + i] *= left_[i] * left_[c];
    }
  }
  if (!factor.is_positive(held)) make_positive(dense_.data(), b.size);
  for (int c = 0; c < b.size; ++c) {
    for (int i = 0; i < b.size; ++i) {
      const int group = i / (kGroup * kTile), within = i % (kGroup * kTile);
      b.inverse[(static_cast<std::size_t>(group) * b.size + c) * kGroup * kTile + within] =
          static_cast<float>(dense_[static_cast<std::size_t>(c) * b.size + i]);
    }
  }
}

}  // namespace palpate::factor
