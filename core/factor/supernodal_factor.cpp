#include "core/factor/supernodal_factor.hpp"

#include <cmath>

#include "core/factor/panel_substitution.hpp"

namespace palpate::factor {
namespace {

constexpr int kPacks = 2;  // packs of right-hand sides solved at once
constexpr int kLanes = substitution::Lanes<kPacks>::kWidth;

int largest_front(const Supernodes& nodes) {
  int rows = nodes.pattern().size() - nodes.pattern().interior_size();
  for (int s = 0; s < nodes.count(); ++s) rows = std::max(rows, nodes.columns(s) + nodes.rows(s));
  return 3 * rows;
}

std::ptrdiff_t square(int rows) { return 9 * static_cast<std::ptrdiff_t>(rows) * rows; }

}  // namespace

SupernodalFactor::SupernodalFactor(const Supernodes& supernodes)
    : supernodes_(&supernodes),
      d_(3 * supernodes.pattern().interior_size()),
      diagonal_(3 * supernodes.pattern().size()),
      scale_(diagonal_.size()),
      dense_(largest_front(supernodes)),
      depth_(supernodes.count()),
      children_(supernodes.count() + 1),
      local_(supernodes.pattern().size(), 0),
      targets_(3 * supernodes.pattern().size()),
      lanes_(kLanes * diagonal_.size()) {
  const BlockPattern& pattern = supernodes.pattern();
  const int count = supernodes.count();
  std::ptrdiff_t size = 0;
  for (int s = 0; s < count; ++s) {
    panel_start_.push_back(size);
    size += 9 * static_cast<std::ptrdiff_t>(supernodes.columns(s)) *
            (supernodes.columns(s) + supernodes.rows(s));
    children_[supernodes.parent(s)].push_back(s);
  }
  panels_.resize(size);
  for (int s = count - 1; s >= 0; --s) {
    const int parent = supernodes.parent(s);
    depth_[s] = parent < count ? depth_[parent] + 1 : 1;
  }
  std::array<std::ptrdiff_t, 2> top{0, 0}, highest{0, 0};
  for (int s = 0; s < count; ++s) {
    std::ptrdiff_t& own = top[depth_[s] % 2];
    own += square(supernodes.rows(s));
    highest[depth_[s] % 2] = std::max(highest[depth_[s] % 2], own);
    for (int child : children_[s]) top[depth_[child] % 2] -= square(supernodes.rows(child));
  }
  for (int k = 0; k < 2; ++k) stacks_[k].resize(highest[k]);

  const int first = pattern.interior_size();
  schur_.resize(square(pattern.size() - first));
  for (int set = 0; set < 4; ++set) {
    const Held held{(set & 1) != 0, (set & 2) != 0};
    if (pattern.held_set(held) != set) continue;
    Border& b = border(held);
    const int begin = held[0] ? pattern.border_begin(1) : first;
    const int end = held[1] ? pattern.border_end(0) : pattern.size();
    b.offset = 3 * (begin - first);
    b.size = 3 * std::max(0, end - begin);
    b.lower.resize(static_cast<std::size_t>(b.size) * b.size);
    b.d.resize(b.size);
  }
}

Pivots SupernodalFactor::pivots(Held held) const {
  Pivots sum = interior_;
  sum.add(border(held).pivots);
  return sum;
}

SupernodalFactor::Storage SupernodalFactor::begin(const BlockMatrix& A, double shift) noexcept {
  const BlockPattern& pattern = supernodes_->pattern();
  for (int k = 0; k < pattern.size(); ++k) {
    const Eigen::Matrix3d& block = A.block(pattern.column_start()[k]);
    for (int axis = 0; axis < 3; ++axis) {
      diagonal_[3 * k + axis] = block(axis, axis) + shift;
      scale_[3 * k + axis] = block.diagonal().cwiseAbs().maxCoeff() + std::abs(shift);
    }
  }
  interior_regular_ = false;
  interior_ = {};
  return {panels_.data(), d_.data(), scale_.data(), schur_.data()};
}

void SupernodalFactor::finish(const Pivots& interior) noexcept {
  interior_ = interior;
  for (Border& border : borders_) factorise_border(border);
  interior_regular_ = true;
}

bool SupernodalFactor::factorise(const BlockMatrix& A, double shift) noexcept {
  const Supernodes& nodes = *supernodes_;
  const BlockPattern& pattern = nodes.pattern();
  begin(A, shift);
  std::array<double*, 2> top{stacks_[0].data(), stacks_[1].data()};
  for (int s = 0; s < nodes.count(); ++s) {
    double*& own = top[depth_[s] % 2];
    const Front front{panels_.data() + panel_start_[s], own, nodes.columns(s), nodes.rows(s)};
    own += square(front.rows);
    clear(front);
    int next = 0;
    for (int k = nodes.begin(s); k < nodes.end(s); ++k) local_[k] = next++;
    for (const int* i = nodes.rows_begin(s); i != nodes.rows_end(s); ++i) local_[*i] = next++;
    assemble(A, nodes.begin(s), front);
    gather(children_[s], top[1 - depth_[s] % 2], front);
    const int begin = 3 * nodes.begin(s);
    if (!dense_.eliminate(front.panel, 3 * (front.columns + front.rows), 3 * front.columns,
                          front.update, &scale_[begin], &d_[begin], interior_)) {
      return false;
    }
  }

  const int first = pattern.interior_size(), rows = pattern.size() - first;
  const Front front{schur_.data(), nullptr, rows, 0};
  std::fill(schur_.begin(), schur_.end(), 0.0);
  for (int i = 0; i < rows; ++i) local_[first + i] = i;
  assemble(A, first, front);
  gather(children_.back(), top[1], front);
  finish(interior_);
  return true;
}

/// Clears a front: the lower half of the update, and the part above it covered by tiles.
void SupernodalFactor::clear(const Front& front) noexcept {
  const int height = 3 * front.rows;
  std::fill_n(front.panel, 9 * front.columns * (front.columns + front.rows), 0.0);
  for (int k = 0; k < height; ++k) {
    double* column = front.update + static_cast<std::ptrdiff_t>(k) * height;
    std::fill(column + std::max(0, k - kTileRows), column + height, 0.0);
  }
}

/// Adds the columns of A from `first` on to those of a front, whose rows are in local_.
void SupernodalFactor::assemble(const BlockMatrix& A, int first, const Front& front) noexcept {
  const BlockPattern& pattern = A.pattern();
  const std::ptrdiff_t height = 3 * (front.columns + front.rows);
  for (int c = 0; c < front.columns; ++c) {
    const int k = first + c;
    double* column = front.panel + 3 * c * height;
    for (int s = pattern.column_start()[k]; s < pattern.column_start()[k + 1]; ++s) {
      double* target = column + 3 * local_[pattern.row()[s]];
      for (int axis = 0; axis < 3; ++axis, target += height) {
        for (int r = 0; r < 3; ++r) target[r] += A.block(s)(r, axis);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      column[axis * height + 3 * c + axis] = diagonal_[3 * k + axis];
    }
  }
}

/// Pops the children's updates from their stack and adds them to a front.
void SupernodalFactor::gather(const std::vector<int>& children, double*& top,
                              const Front& front) noexcept {
  const Supernodes& nodes = *supernodes_;
  const std::ptrdiff_t height = 3 * (front.columns + front.rows), below = 3 * front.rows;
  for (std::size_t c = children.size(); c-- > 0;) {
    const int* unknowns = nodes.rows_begin(children[c]);
    const int rows = nodes.rows(children[c]);
    top -= square(rows);
    const double* source = top;
    for (int i = 0; i < rows; ++i) targets_[i] = 3 * local_[unknowns[i]];
    for (int k = 0; k < 3 * rows; ++k, source += 3 * rows) {
      const int column = targets_[k / 3] + k % 3 - 3 * front.columns;
      double* target = column < 0 ? front.panel + (column + 3 * front.columns) * height
                                  : front.update + column * below - 3 * front.columns;
      for (int i = k / 3; i < rows; ++i) {
        for (int r = 0; r < 3; ++r) target[targets_[i] + r] += source[3 * i + r];
      }
    }
  }
}

void SupernodalFactor::factorise_border(Border& border) noexcept {
  const BlockPattern& pattern = supernodes_->pattern();
  const int first = 3 * pattern.interior_size();
  const std::ptrdiff_t all = 3 * pattern.size() - first;
  for (int k = 0; k < border.size; ++k) {
    const double* source = schur_.data() + (border.offset + k) * all + border.offset;
    std::copy(source, source + border.size,
              &border.lower[static_cast<std::ptrdiff_t>(k) * border.size]);
  }
  border.pivots = {};
  border.regular =
      dense_.eliminate(border.lower.data(), border.size, border.size, nullptr,
                       scale_.data() + first + border.offset, border.d.data(), border.pivots);
}

void SupernodalFactor::solve(Eigen::Ref<Eigen::MatrixXd> B, Held held) const noexcept {
  const int columns = static_cast<int>(B.cols());
  int begin = 0;
  for (; begin + kLanes / 2 < columns; begin += kLanes) {
    solve_lanes<kPacks>(B.middleCols(begin, std::min(kLanes, columns - begin)), held);
  }
  if (begin < columns) solve_lanes<kPacks / 2>(B.rightCols(columns - begin), held);
}

template <int kPacks>
void SupernodalFactor::solve_lanes(Eigen::Ref<Eigen::MatrixXd> B, Held held) const noexcept {
  constexpr int kWidth = substitution::Lanes<kPacks>::kWidth;
  const Supernodes& nodes = *supernodes_;
  const Border& free = border(held);
  const int n = static_cast<int>(B.rows()), first = 3 * nodes.pattern().interior_size();
  const int free_begin = first + free.offset, free_end = free_begin + free.size;
  const auto is_free = [&](int i) { return i < first || (i >= free_begin && i < free_end); };
  double* lanes = lanes_.data();
  std::fill_n(lanes, n * kWidth, 0.0);
  for (int l = 0; l < B.cols(); ++l) {
    for (int i = 0; i < n; ++i) lanes[i * kWidth + l] = B(i, l);
  }

  int* offsets = targets_.data();
  const auto panel_of = [&](int s) {
    int *own = offsets, rows = 3 * (nodes.columns(s) + nodes.rows(s));
    for (int i = 3 * nodes.begin(s); i < 3 * nodes.end(s); ++i) *own++ = i * kWidth;
    for (const int* i = nodes.rows_begin(s); i != nodes.rows_end(s); ++i) {
      for (int axis = 0; axis < 3; ++axis) *own++ = (3 * *i + axis) * kWidth;
    }
    return substitution::Panel{panel(s), rows, 3 * nodes.columns(s), rows, offsets, lanes};
  };
  for (int s = 0; s < nodes.count(); ++s) substitution::forward<kPacks>(panel_of(s));
  substitution::divide<kPacks>(lanes, d_.data(), first);
  for (int i = 0; i < free.size; ++i) offsets[i] = i * kWidth;
  double* free_lanes = lanes + free_begin * kWidth;
  const substitution::Panel own{free.lower.data(), free.size, free.size,
                                free.size,         offsets,   free_lanes};
  substitution::forward<kPacks>(own);
  substitution::divide<kPacks>(free_lanes, free.d.data(), free.size);
  substitution::backward<kPacks>(own);
  std::fill(lanes + first * kWidth, free_lanes, 0.0);
  std::fill(lanes + free_end * kWidth, lanes + n * kWidth, 0.0);
  for (int s = nodes.count() - 1; s >= 0; --s) substitution::backward<kPacks>(panel_of(s));
  for (int l = 0; l < B.cols(); ++l) {
    for (int i = 0; i < n; ++i) B(i, l) = is_free(i) ? lanes[i * kWidth + l] : 0;
  }
}

void SupernodalFactor::invert_border(Held held, double* inverse) const noexcept {
  const Border& free = border(held);
  const int n = free.size;
  for (int i = 0; i < n; ++i) targets_[i] = i * kLanes;
  for (int begin = 0; begin < n; begin += kLanes) {
    const int count = std::min(kLanes, n - begin);
    std::fill(lanes_.begin(), lanes_.begin() + n * kLanes, 0.0);
    for (int l = 0; l < count; ++l) lanes_[(begin + l) * kLanes + l] = 1;
    // all preceding entries are zero in every lane
    const double* lower = free.lower.data() + static_cast<std::ptrdiff_t>(begin) * (n + 1);
    substitution::forward<kPacks>(
        {lower, n, n - begin, n - begin, targets_.data(), lanes_.data() + begin * kLanes});
    substitution::divide<kPacks>(lanes_.data(), free.d.data(), n);
    substitution::backward<kPacks>({free.lower.data(), n, n, n, targets_.data(), lanes_.data()});
    for (int l = 0; l < count; ++l) {
      for (int i = 0; i < n; ++i) inverse[(begin + l) * n + i] = lanes_[i * kLanes + l];
    }
  }
}

}  // namespace palpate::factor
