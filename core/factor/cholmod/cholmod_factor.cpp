#include "core/factor/cholmod/cholmod_factor.hpp"

#include <cholmod.h>

#include <Eigen/Core>
#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/factor/cholmod/one_thread.hpp"
#include "core/math/blas.hpp"

namespace palpate::factor {
namespace {

/// As in DenseLdl: a pivot that vanishes to rounding relative to the scale.
constexpr double kVanishing = 1e-11;

void* copied(const std::vector<int>& list, cholmod_common& common) {
  auto* copy = static_cast<int*>(cholmod_malloc(list.size(), sizeof(int), &common));
  if (copy == nullptr) throw std::bad_alloc();
  std::copy(list.begin(), list.end(), copy);
  return copy;
}

}  // namespace

struct CholmodFactor::Parts {
  cholmod_common common{};
  cholmod_sparse* matrix = nullptr;  // lower triangle, column by column
  cholmod_factor* factor = nullptr;  // its numbers are those of the panels

  Parts() {
    if (cholmod_start(&common) == 0) throw std::runtime_error("CHOLMOD cannot be started");
    common.print = 0;
    common.quick_return_if_not_posdef = 1;
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
  ~Parts() {
    if (factor != nullptr) factor->x = nullptr;
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&matrix, &common);
    cholmod_finish(&common);
  }
};

CholmodFactor::CholmodFactor(const Supernodes& nodes)
    : SupernodalFactor(nodes), parts_(std::make_unique<Parts>()) {
  const std::string problem = math::problem_of(math::hold_blas_to_one_thread());
  if (!problem.empty()) throw std::runtime_error(problem);
  lay_out_matrix();
  lay_out_factor();
}

CholmodFactor::~CholmodFactor() = default;

/// Sparsity of the lower triangle over interior and border, in scalars.
void CholmodFactor::lay_out_matrix() {
  const BlockPattern& pattern = supernodes().pattern();
  const auto n = 3 * static_cast<std::size_t>(pattern.size());
  const auto blocks = pattern.row().size();
  const std::size_t entries = 9 * blocks - 3 * static_cast<std::size_t>(pattern.size());
  parts_->matrix = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, &parts_->common);
  if (parts_->matrix == nullptr) throw std::bad_alloc();
  auto* start = static_cast<int*>(parts_->matrix->p);
  auto* row = static_cast<int*>(parts_->matrix->i);
  int count = 0;
  for (int k = 0; k < pattern.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      *start++ = count;
      for (int s = pattern.column_start()[k]; s < pattern.column_start()[k + 1]; ++s) {
        const bool is_diagonal = s == pattern.column_start()[k];
        for (int r = is_diagonal ? axis : 0; r < 3; ++r) row[count++] = 3 * pattern.row()[s] + r;
      }
    }
  }
  *start = count;
}

/// The supernodes of the panels as CHOLMOD describes a symbolic factor, and one more for the
/// border. Rows of a supernode are contained in those of its ancestors, as CHOLMOD requires.
void CholmodFactor::lay_out_factor() {
  const Supernodes& nodes = supernodes();
  const BlockPattern& pattern = nodes.pattern();
  const int first = pattern.interior_size();
  std::vector<int> begin, row_start, panel_start, rows, holder(pattern.size(), nodes.count());
  std::size_t scalars = 0;
  const auto add = [&](int from, int to, const int* below, const int* end) {
    begin.push_back(3 * from);
    row_start.push_back(static_cast<int>(rows.size()));
    panel_start.push_back(static_cast<int>(scalars));
    for (int i = 3 * from; i < 3 * to; ++i) rows.push_back(i);
    for (; below != end; ++below) {
      for (int axis = 0; axis < 3; ++axis) rows.push_back(3 * *below + axis);
    }
    scalars += 3 * static_cast<std::size_t>(to - from) * (rows.size() - row_start.back());
  };
  for (int s = 0; s < nodes.count(); ++s) {
    add(nodes.begin(s), nodes.end(s), nodes.rows_begin(s), nodes.rows_end(s));
    std::fill(holder.begin() + nodes.begin(s), holder.begin() + nodes.end(s), s);
  }
  border_panel_ = static_cast<std::ptrdiff_t>(scalars);
  if (first < pattern.size()) add(first, pattern.size(), nullptr, nullptr);
  const std::size_t count = begin.size();
  begin.push_back(3 * pattern.size());
  row_start.push_back(static_cast<int>(rows.size()));
  panel_start.push_back(static_cast<int>(scalars));
  extend_panels(static_cast<std::ptrdiff_t>(scalars) - border_panel_);

  cholmod_common& common = parts_->common;
  cholmod_factor* factor = cholmod_allocate_factor(parts_->matrix->nrow, &common);
  if (factor == nullptr) throw std::bad_alloc();
  parts_->factor = factor;
  factor->nsuper = count;
  factor->ssize = rows.size();
  factor->xsize = scalars;
  // The largest product that is subtracted from a supernode at once, and the rows of the widest.
  for (int s = 0; s < nodes.count(); ++s) {
    const int* const end = nodes.rows_end(s);
    factor->maxesize = std::max<std::size_t>(factor->maxesize, 3 * nodes.rows(s));
    for (const int* row = nodes.rows_begin(s); row != end;) {
      const int target = holder[*row];
      const int* const within = std::find_if(row, end, [&](int i) { return holder[i] != target; });
      const std::size_t size = 9 * static_cast<std::size_t>(within - row) * (end - row);
      factor->maxcsize = std::max(factor->maxcsize, size);
      row = within;
    }
  }
  factor->super = copied(begin, common);
  factor->pi = copied(row_start, common);
  factor->px = copied(panel_start, common);
  factor->s = copied(rows, common);
  factor->is_super = 1;
  factor->is_ll = 1;
  factor->xtype = CHOLMOD_REAL;
  factor->dtype = CHOLMOD_DOUBLE;
  factor->ordering = CHOLMOD_NATURAL;
}

/// Copies the values. The diagonal of the border is increased by `scale`, because the border must
/// not decide whether a matrix is positive definite; the factor of the interior does not depend on
/// it.
void CholmodFactor::load(const BlockMatrix& A, const double* scale) noexcept {
  const BlockPattern& pattern = supernodes().pattern();
  const auto* start = static_cast<const int*>(parts_->matrix->p);
  auto* values = static_cast<double*>(parts_->matrix->x);
  for (int k = 0; k < pattern.size(); ++k) {
    double* column[3];
    const int own = pattern.column_start()[k];
    for (int axis = 0; axis < 3; ++axis) {
      const int i = 3 * k + axis;
      column[axis] = values + start[i];
      *column[axis]++ = diagonal()[i] + (k < pattern.interior_size() ? 0 : scale[i]);
      for (int r = axis + 1; r < 3; ++r) *column[axis]++ = A.block(own)(r, axis);
    }
    for (int s = own + 1; s < pattern.column_start()[k + 1]; ++s) {
      const double* block = A.block(s).data();
      for (double*& target : column) {
        for (int r = 0; r < 3; ++r) *target++ = *block++;
      }
    }
  }
}

/// Converts columns of L in L L^T to those in L D L^T, in place, and the border's factor to its
/// Schur complement. False if a pivot vanishes.
bool CholmodFactor::take_over(const Storage& storage) noexcept {
  const Supernodes& nodes = supernodes();
  const BlockPattern& pattern = nodes.pattern();
  const double* scale = storage.scale;
  double *d = storage.d, *column = storage.panels;
  Pivots pivots;
  for (int s = 0; s < nodes.count(); ++s) {
    const int columns = 3 * nodes.columns(s), rows = columns + 3 * nodes.rows(s);
    for (int k = 0; k < columns; ++k, column += rows, ++d, ++scale) {
      const double root = column[k], inverse = 1 / root;
      *d = root * root;
      if (!(*d > kVanishing * *scale)) return false;
      pivots.smallest = std::min(pivots.smallest, *d / *scale);
      for (int i = k + 1; i < rows; ++i) column[i] *= inverse;
    }
  }
  const int size = 3 * (pattern.size() - pattern.interior_size());
  if (size > 0) {
    using Eigen::Lower;
    Eigen::Map<Eigen::MatrixXd> L(storage.panels + border_panel_, size, size);
    Eigen::Map<Eigen::MatrixXd> S(storage.schur, size, size);
    S.setZero();
    L.triangularView<Eigen::StrictlyUpper>().setZero();
    S.selfadjointView<Lower>().rankUpdate(L);
    for (int i = 0; i < size; ++i) S(i, i) -= scale[i];
  }
  finish(pivots);
  return true;
}

bool CholmodFactor::factorise(const BlockMatrix& A, double shift) noexcept {
  const Storage storage = begin(A, shift);
  load(A, storage.scale);
  parts_->factor->x = storage.panels;
  const double begun = clock_ != nullptr ? clock_() : 0;
  {
    const OneThread one_thread;
    double beta[2] = {0, 0};
    parts_->common.status = CHOLMOD_OK;
    cholmod_super_numeric(parts_->matrix, nullptr, beta, parts_->factor, &parts_->common);
  }
  bare_time_ = clock_ != nullptr ? clock_() - begun : 0;
  is_cholmod_ = parts_->common.status == CHOLMOD_OK && take_over(storage);
  return is_cholmod_ || SupernodalFactor::factorise(A, shift);
}

std::unique_ptr<SupernodalFactor> make_cholmod_factor(const Supernodes& supernodes) {
  return std::make_unique<CholmodFactor>(supernodes);
}

}  // namespace palpate::factor
