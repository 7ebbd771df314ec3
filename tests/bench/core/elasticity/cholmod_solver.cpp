#include "tests/bench/core/elasticity/cholmod_solver.hpp"

#include <cholmod.h>

#include <stdexcept>

#include "core/factor/cholmod/one_thread.hpp"
#include "core/math/blas.hpp"

namespace palpate::bench {

struct CholmodSolver::Parts {
  cholmod_common common{};
  cholmod_sparse* matrix = nullptr;  // upper triangle, column by column
  cholmod_factor* factor = nullptr;
  cholmod_dense* right = nullptr;
  cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

  Parts() { cholmod_start(&common); }
  ~Parts() {
    for (cholmod_dense** d : {&right, &solution, &work_y, &work_e}) cholmod_free_dense(d, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&matrix, &common);
    cholmod_finish(&common);
  }

  /// Elimination order of the nodes.
  std::vector<int> node_order(const BlockRows& pattern) {
    cholmod_sparse* graph =
        cholmod_allocate_sparse(pattern.size(), pattern.size(), pattern.column.size(), true, true,
                                1, CHOLMOD_PATTERN, &common);
    auto* start = static_cast<int*>(graph->p);
    auto* row = static_cast<int*>(graph->i);
    int count = 0;
    for (int j = 0; j < pattern.size(); ++j) {
      start[j] = count;
      for (int k = pattern.row_start[j]; k < pattern.row_start[j + 1]; ++k) {
        if (pattern.column[k] <= j) row[count++] = pattern.column[k];
      }
    }
    start[pattern.size()] = count;
    common.nmethods = 2;
    common.method[0].ordering = CHOLMOD_METIS;
    common.method[1].ordering = CHOLMOD_AMD;
    cholmod_factor* symbolic = cholmod_analyze(graph, &common);
    const auto* order = static_cast<const int*>(symbolic->Perm);
    std::vector<int> result(order, order + pattern.size());
    cholmod_free_factor(&symbolic, &common);
    cholmod_free_sparse(&graph, &common);
    return result;
  }

  void make_matrix(const BlockRows& pattern) {
    const std::size_t n = 3 * static_cast<std::size_t>(pattern.size());
    matrix = cholmod_allocate_sparse(n, n, 9 * pattern.column.size(), true, true, 1, CHOLMOD_REAL,
                                     &common);
    auto* start = static_cast<int*>(matrix->p);
    auto* row = static_cast<int*>(matrix->i);
    int count = 0;
    for (int j = 0; j < pattern.size(); ++j) {
      for (int c = 0; c < 3; ++c) {
        start[3 * j + c] = count;
        for (int k = pattern.row_start[j]; k < pattern.row_start[j + 1]; ++k) {
          const int i = pattern.column[k];
          for (int r = 0; r < 3 && 3 * i + r <= 3 * j + c; ++r) row[count++] = 3 * i + r;
        }
      }
    }
    start[n] = count;
  }
};

CholmodSolver::CholmodSolver(const BlockRows& pattern) : parts_(std::make_unique<Parts>()) {
  cholmod_common* common = &parts_->common;
  common->print = 0;
  std::vector<int> order;
  for (int node : parts_->node_order(pattern)) {
    for (int c = 0; c < 3; ++c) order.push_back(3 * node + c);
  }
  parts_->make_matrix(pattern);
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_GIVEN;
  common->supernodal = CHOLMOD_SUPERNODAL;
  parts_->factor = cholmod_analyze_p(parts_->matrix, order.data(), nullptr, 0, common);
  if (parts_->factor == nullptr) throw std::runtime_error("CHOLMOD cannot analyse the matrix");
  parts_->right =
      cholmod_zeros(3 * static_cast<std::size_t>(pattern.size()), 1, CHOLMOD_REAL, common);
}

CholmodSolver::~CholmodSolver() = default;

bool CholmodSolver::factorise(const BlockRows& A) {
  const factor::OneThread one_thread;
  math::hold_blas_to_one_thread();
  auto* value = static_cast<double*>(parts_->matrix->x);
  for (int j = 0; j < A.size(); ++j) {
    for (int c = 0; c < 3; ++c) {
      for (int k = A.row_start[j]; k < A.row_start[j + 1]; ++k) {
        const int i = A.column[k];
        // Column c of block (i, j), which is row c of the stored (j, i).
        for (int r = 0; r < 3 && 3 * i + r <= 3 * j + c; ++r) *value++ = A.blocks[k](c, r);
      }
    }
  }
  cholmod_factorize(parts_->matrix, parts_->factor, &parts_->common);
  return parts_->common.status == CHOLMOD_OK;
}

void CholmodSolver::solve(const Eigen::Matrix4Xd& b, Eigen::Matrix4Xd& x) {
  Eigen::Map<Eigen::Matrix3Xd>(static_cast<double*>(parts_->right->x), 3, b.cols()) =
      b.topRows<3>();
  cholmod_solve2(CHOLMOD_A, parts_->factor, parts_->right, nullptr, &parts_->solution, nullptr,
                 &parts_->work_y, &parts_->work_e, &parts_->common);
  x.topRows<3>() = Eigen::Map<const Eigen::Matrix3Xd>(
      static_cast<const double*>(parts_->solution->x), 3, b.cols());
  x.row(3).setZero();
}

double CholmodSolver::factor_entries() const { return parts_->common.lnz; }

}  // namespace palpate::bench
