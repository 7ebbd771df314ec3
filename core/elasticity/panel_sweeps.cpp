#include <algorithm>

#include "core/elasticity/panel_kernel.hpp"
#include "core/elasticity/solve_panels.hpp"

// The loop's side of the panels: who does what, and the two sweeps over them.
namespace palpate::elasticity {
namespace {

using panel_kernel::kGroup;
using panel_kernel::kTile;
using panel_kernel::tiles_of;

/// The level up to which the rows of panels are needed: 0 interior, 1 and group 0, 2 and group 1.
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
  for (int s : shares.top) top_.push_back(span(s, s + 1));
  top_.push_back({0, 0, interior_, size_of_b_});
}

void SolvePanels::scale(const Span& rows, const float* from, float* to) const noexcept {
  for (int i = rows.begin; i < rows.end; ++i) to[i] = from[i] * scaling_[i];
}

/// From the leaves to the root: (z; delta) = P b.
template <class Stored>
void SolvePanels::sweep_up(const Span& span, int level, float* b, Desk& desk) const noexcept {
  float* rows = desk.rows.data();
  for (int s = span.panels_begin; s < span.panels_end; ++s) {
    const Panel& panel = panels_[s];
    float* own = b + panel.first;
    for (int k = panel.rectangles; k < panel.rectangles_end[level]; ++k) {
      const Rectangle& r = rectangles_[k];
      multiply(r.height, stored<Stored>(r), own + r.begin, r.end - r.begin, r.begin == 0,
               rows + r.tile * kTile);
    }
    for (int i = 0; i < panel.columns; ++i) own[i] = rows[i];
    const float* delta = rows + panel.columns;
    for (int k = panel.runs; k < panel.runs_end[level]; ++k) {
      float* target = b + runs_[k].target;
      for (int i = 0; i < runs_[k].count; ++i) target[i] += *delta++;
    }
  }
}

/// And back: x = P^T (z; x_rows).
template <class Stored>
void SolvePanels::sweep_down(const Span& span, int level, float* b, Desk& desk) const noexcept {
  float *rows = desk.rows.data(), *sums = desk.sums.data();
  for (int s = span.panels_end; s-- > span.panels_begin;) {
    const Panel& panel = panels_[s];
    float *own = b + panel.first, *x = rows;
    for (int i = 0; i < panel.columns; ++i) *x++ = own[i];
    for (int k = panel.runs; k < panel.runs_end[level]; ++k) {
      const float* source = b + runs_[k].target;
      for (int i = 0; i < runs_[k].count; ++i) *x++ = source[i];
    }
    std::fill(x, rows + tiles_of(panel.rows[level]) * kTile, 0.0f);
    std::fill(sums, sums + panel.columns * kTile, 0.0f);
    for (int k = panel.rectangles; k < panel.rectangles_end[level]; ++k) {
      const Rectangle& r = rectangles_[k];
      multiply_transposed(r.height, stored<Stored>(r), rows + r.tile * kTile, r.end - r.begin,
                          sums + r.begin * kTile);
    }
    float totals[kTile];
    for (int c = 0; c < panel.columns; c += kTile) {
      panel_kernel::add_lanes(sums + c * kTile, totals);
      std::copy(totals, totals + std::min(kTile, panel.columns - c), own + c);
    }
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
    for (const Span& span : top_) {
      if (member == 0) {
        scale(span, b, b);
      } else {
        std::fill(own + span.begin, own + span.end, 0.0f);
      }
    }
    for (const Span& span : desk.spans) {
      scale(span, b, own);
      sweep_up<Stored>(span, level, own, desk);
      if (member != 0) std::copy(own + span.begin, own + span.end, b + span.begin);
    }
  };
  team_->run(up);
  for (const Span& span : top_) {
    for (std::size_t m = 1; m < desks_.size(); ++m) {
      const float* delta = desks_[m].vector.data();
      for (int i = span.begin; i < span.end; ++i) b[i] += delta[i];
    }
  }
  for (const Span& span : top_) sweep_up<Stored>(span, level, b, desks_[0]);
  solve_border(b, border(held));
  for (auto span = top_.rbegin(); span != top_.rend(); ++span) {
    sweep_down<Stored>(*span, level, b, desks_[0]);
  }
  const auto down = [this, b, level](int member, int) {
    Desk& desk = desks_[member];
    for (const Span& span : desk.spans) {
      sweep_down<Stored>(span, level, b, desk);
      scale(span, b, b);
    }
  };
  team_->run(down);
  for (const Span& span : top_) scale(span, b, b);
}

void SolvePanels::solve(float* b, Held held) noexcept {
#if PALPATE_HAS_HALF
  half_ ? sweep<std::uint16_t>(b, held) : sweep<float>(b, held);
#else
  sweep<float>(b, held);
#endif
}

}  // namespace palpate::elasticity
