#include "tests/bench/core/math/quadprog_peer.hpp"

#include <dlfcn.h>

#include <cmath>

namespace palpate::bench {

std::unique_ptr<QuadprogPeer> QuadprogPeer::open() {
  void* library = dlopen("/usr/lib/R/site-library/quadprog/libs/quadprog.so", RTLD_NOW);
  void* solve = library ? dlsym(library, "qpgen2_") : nullptr;
  if (!solve) return nullptr;
  return std::unique_ptr<QuadprogPeer>(new QuadprogPeer(reinterpret_cast<Solve>(solve)));
}

void QuadprogPeer::load(const math::QuadraticProgram& program) {
  const int n = program.variables();
  H_ = program.H;
  H_.triangularView<Eigen::StrictlyUpper>() = H_.transpose();
  g_ = -program.g;  // it maximises
  rows_.resize(n, 2 * program.rows());
  bounds_.resize(2 * program.rows());
  int count = 0;
  const auto add = [&](int row, double sign, double bound) {
    rows_.col(count) = sign * program.A.col(row);
    bounds_[count++] = sign * bound;
  };
  for (int i = 0; i < program.rows(); ++i) {
    if (program.bounds[i].lower == program.bounds[i].upper) add(i, 1, program.bounds[i].lower);
  }
  equations_ = count;
  for (int i = 0; i < program.rows(); ++i) {
    const auto& bounds = program.bounds[i];
    if (bounds.lower == bounds.upper) continue;
    if (std::isfinite(bounds.lower)) add(i, 1, bounds.lower);
    if (std::isfinite(bounds.upper)) add(i, -1, bounds.upper);
  }
  rows_.conservativeResize(n, count);
  bounds_.conservativeResize(count);
  u_.setZero(n);
  multipliers_.setZero(count);
  active_.setZero(count);
  const int least = std::min(n, count);
  work_.setZero(2 * n + least * (least + 5) / 2 + 2 * count + 1);
}

bool QuadprogPeer::solve() {
  const int n = static_cast<int>(u_.size());
  const int count = static_cast<int>(bounds_.size());
  double value = 0;
  int active = 0;
  int iterations[2] = {};
  int error = 0;  // H is not factored yet
  solve_(H_.data(), g_.data(), &n, &n, u_.data(), multipliers_.data(), &value, rows_.data(),
         bounds_.data(), &n, &count, &equations_, active_.data(), &active, iterations, work_.data(),
         &error);
  return error == 0;
}

}  // namespace palpate::bench
