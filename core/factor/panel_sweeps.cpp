#include <algorithm>

#include "core/factor/panel_kernel.hpp"
#include "core/factor/solve_panels.hpp"

// Solution phase of the panels: distribution of the work and the two sweeps.
namespace palpate::factor {
namespace {

using panel_kernel::kGroup;
using panel_kernel::kTile;
using panel_kernel::tiles_of;

/// Level up to which rows of the panels are needed: 0 interior, 1 also group 0, 2 also group 1.
int level_of(Held held) { return !held[1] ? 2 : !held[0] ? 1 : 0; }

template <class Stored>
void multiply(int height, const Stored* a, const float* b, int columns, bool first, float* y) {
  switch (height) {
    case 1:
      return panel_kernel::multiply<1>(a, b, columns, first, y);
    case 2:
      return panel_kernel::multiply<2>(a, b, columns, first, y);
    case 3:
      return panel_kernel::multiply<3>(a, b, columns, first, y);
    default:
      return panel_kernel::multiply<4>(a, b, columns, first, y);
  }
}

template <class Stored>
void multiply_transposed(int height, const Stored* a, const float* x, int columns, float* sums) {
  switch (height) {
    case 1:
      return panel_kernel::multiply_transposed<1>(a, x, columns, sums);
    case 2:
      return panel_kernel::multiply_transposed<2>(a, x, columns, sums);
    case 3:
      return panel_kernel::multiply_transposed<3>(a, x, columns, sums);
    default:
      return panel_kernel::multiply_transposed<4>(a, x, columns, sums);
  }
}

}  // namespace

SolvePanels::Span SolvePanels::span(int panels_begin, int panels_end) const {
  if (panels_begin == panels_end) return {panels_begin, panels_end, 0, 0};
  const Panel& last = panels_[panels_end - 1];
  return {panels_begin, panels_end, panels_[panels_begin].first, last.first + last.columns};
}

void SolvePanels::share_out(const TreeShares& shares) {
  for (const std::vector<TreeShares::Range>& ranges : shares.members) {
    Desk& desk = desks_.emplace_back();
    for (const auto& range : ranges) desk.spans.push_back(span(range.begin, range.end));
  }
  for (const TreeShares::Top& top : shares.top) {
    top_.push_back({span(top.node, top.node + 1), {}});
    if (top.is_shared) top_.back().shares = split(panels_[top.node]);
  }
  top_.push_back({{0, 0, interior_, size_of_b_}, {}});
}

/// Starting rows of the members' rectangles of a panel, and the end of the last one: about equal
/// numbers of bytes, and no row shared by two members.
std::vector<int> SolvePanels::split(const Panel& panel) const {
  const std::size_t members = desks_.size();
  const int end = panel.rectangles_end.back();
  const bool is_last = end == static_cast<int>(rectangles_.size());
  const std::size_t from = rectangles_[panel.rectangles].offset;
  const std::size_t bytes = (is_last ? size_ : rectangles_[end].offset) - from;
  std::vector<int> shares{panel.rectangles};
  for (int k = panel.rectangles; k < end; ++k) {
    const Rectangle& r = rectangles_[k];
    const bool starts_rows = r.begin == 0;
    if (starts_rows && (r.offset - from) * members >= bytes * shares.size()) shares.push_back(k);
  }
  shares.resize(members, end);
  shares.push_back(end);
  return shares;
}

void SolvePanels::scale(const Span& rows, const float* from, float* to) const noexcept {
  for (int i = rows.begin; i < rows.end; ++i) to[i] = from[i] * scaling_[i];
}

/// rows = P b for the rows of some rectangles.
template <class Stored>
void SolvePanels::multiply_rows(int begin, int end, const float* b, float* rows) const noexcept {
  for (int k = begin; k < end; ++k) {
    const Rectangle& r = rectangles_[k];
    multiply(r.height, stored<Stored>(r), b + r.begin, r.end - r.begin, r.begin == 0,
             rows + r.tile * kTile);
  }
}

/// The first `columns` entries of sums = P^T rows, over some rectangles.
template <class Stored>
void SolvePanels::multiply_columns(int begin, int end, const float* rows, int columns,
                                   float* sums) const noexcept {
  std::fill(sums, sums + columns * kTile, 0.0f);
  for (int k = begin; k < end; ++k) {
    const Rectangle& r = rectangles_[k];
    multiply_transposed(r.height, stored<Stored>(r), rows + r.tile * kTile, r.end - r.begin,
                        sums + r.begin * kTile);
  }
  float totals[kTile];
  for (int c = 0; c < columns; c += kTile) {
    panel_kernel::add_lanes(sums + c * kTile, totals);
    std::copy(totals, totals + kTile, sums + c);
  }
}

void SolvePanels::scatter(const Panel& panel, int level, const float* rows,
                          float* b) const noexcept {
  std::copy(rows, rows + panel.columns, b + panel.first);
  const float* delta = rows + panel.columns;
  for (int k = panel.runs; k < panel.runs_end[level]; ++k) {
    float* target = b + runs_[k].target;
    for (int i = 0; i < runs_[k].count; ++i) target[i] += *delta++;
  }
}

void SolvePanels::gather(const Panel& panel, int level, const float* b,
                         float* rows) const noexcept {
  float* x = std::copy(b + panel.first, b + panel.first + panel.columns, rows);
  for (int k = panel.runs; k < panel.runs_end[level]; ++k) {
    const float* source = b + runs_[k].target;
    for (int i = 0; i < runs_[k].count; ++i) *x++ = source[i];
  }
  std::fill(x, rows + tiles_of(panel.rows[level]) * kTile, 0.0f);
}

/// Forward sweep from the leaves to the root: (z; delta) = P b.
template <class Stored>
void SolvePanels::sweep_up(const Span& span, int level, float* b, Desk& desk) const noexcept {
  float* rows = desk.rows.data();
  for (int s = span.panels_begin; s < span.panels_end; ++s) {
    const Panel& panel = panels_[s];
    multiply_rows<Stored>(panel.rectangles, panel.rectangles_end[level], b + panel.first, rows);
    scatter(panel, level, rows, b);
  }
}

/// Backward sweep: x = P^T (z; x_rows).
template <class Stored>
void SolvePanels::sweep_down(const Span& span, int level, float* b, Desk& desk) const noexcept {
  float *rows = desk.rows.data(), *sums = desk.sums.data();
  for (int s = span.panels_end; s-- > span.panels_begin;) {
    const Panel& panel = panels_[s];
    gather(panel, level, b, rows);
    multiply_columns<Stored>(panel.rectangles, panel.rectangles_end[level], rows, panel.columns,
                             sums);
    std::copy(sums, sums + panel.columns, b + panel.first);
  }
}

/// One panel whose rows are shared among the members.
template <class Stored>
void SolvePanels::sweep_up_together(const Top& top, int level, float* b) noexcept {
  const Panel& panel = panels_[top.span.panels_begin];
  float* rows = desks_[0].rows.data();
  const auto work = [&](int member, int) {
    const int end = std::min(top.shares[member + 1], panel.rectangles_end[level]);
    multiply_rows<Stored>(top.shares[member], end, b + panel.first, rows);
  };
  team_->run(work);
  scatter(panel, level, rows, b);
}

template <class Stored>
void SolvePanels::sweep_down_together(const Top& top, int level, float* b) noexcept {
  const Panel& panel = panels_[top.span.panels_begin];
  float *rows = desks_[0].rows.data(), *own = b + panel.first;
  gather(panel, level, b, rows);
  const auto work = [&](int member, int) {
    const int end = std::min(top.shares[member + 1], panel.rectangles_end[level]);
    multiply_columns<Stored>(top.shares[member], end, rows, panel.columns,
                             desks_[member].sums.data());
  };
  team_->run(work);
  std::copy(desks_[0].sums.begin(), desks_[0].sums.begin() + panel.columns, own);
  for (std::size_t m = 1; m < desks_.size(); ++m) {
    for (int i = 0; i < panel.columns; ++i) own[i] += desks_[m].sums[i];
  }
}

void SolvePanels::solve_border(float* b, const Border& border) noexcept {
  float *own = b + border.offset, *rows = desks_[0].rows.data();
  for (int i = 0; i < border.size; i += kGroup * kTile) {
    multiply(kGroup, &border.inverse[static_cast<std::size_t>(i) * border.size], own, border.size,
             true, rows + i);
  }
  std::fill(b + interior_, b + size_of_b_, 0.0f);
  std::copy(rows, rows + border.size, own);
}

template <class Stored>
void SolvePanels::sweep(float* b, Held held) noexcept {
  const int level = level_of(held);
  const auto up = [this, b, level](int member, int) {
    Desk& desk = desks_[member];
    float* own = member == 0 ? b : desk.vector.data();
    for (const Top& top : top_) {
      if (member == 0) {
        scale(top.span, b, b);
      } else {
        std::fill(own + top.span.begin, own + top.span.end, 0.0f);
      }
    }
    for (const Span& span : desk.spans) {
      scale(span, b, own);
      sweep_up<Stored>(span, level, own, desk);
      if (member != 0) std::copy(own + span.begin, own + span.end, b + span.begin);
    }
  };
  team_->run(up);
  for (const Top& top : top_) {
    for (std::size_t m = 1; m < desks_.size(); ++m) {
      const float* delta = desks_[m].vector.data();
      for (int i = top.span.begin; i < top.span.end; ++i) b[i] += delta[i];
    }
  }
  for (const Top& top : top_) {
    top.shares.empty() ? sweep_up<Stored>(top.span, level, b, desks_[0])
                       : sweep_up_together<Stored>(top, level, b);
  }
  solve_border(b, border(held));
  for (auto top = top_.rbegin(); top != top_.rend(); ++top) {
    top->shares.empty() ? sweep_down<Stored>(top->span, level, b, desks_[0])
                        : sweep_down_together<Stored>(*top, level, b);
  }
  const auto down = [this, b, level](int member, int) {
    Desk& desk = desks_[member];
    for (const Span& span : desk.spans) {
      sweep_down<Stored>(span, level, b, desk);
      scale(span, b, b);
    }
  };
  team_->run(down);
  for (const Top& top : top_) scale(top.span, b, b);
}

void SolvePanels::solve(float* b, Held held) noexcept {
#if PALPATE_HAS_HALF
  half_ ? sweep<std::uint16_t>(b, held) : sweep<float>(b, held);
#else
  sweep<float>(b, held);
#endif
}

}  // namespace palpate::factor
