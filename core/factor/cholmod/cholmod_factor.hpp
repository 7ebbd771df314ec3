#pragma once

#include <cstddef>
#include <memory>

#include "core/factor/supernodal_factor.hpp"

namespace palpate::factor {

/// Computes the factor by CHOLMOD's supernodal L L^T (Chen, Davis, Hager, Rajamanickam 2008), in
/// the calling thread alone, where the interior is positive definite. Otherwise the own L D L^T
/// takes over within the same call, so that pivots always have their signs. CHOLMOD is given the
/// supernodes of the panels and writes into them: nothing is converted but the scale of columns.
/// factorise() allocates CHOLMOD's workspace. The last bits depend on the BLAS and on the processor
/// for which it selects its kernels.
class CholmodFactor final : public SupernodalFactor {
 public:
  /// `supernodes` must outlive the factor. Throws std::bad_alloc, and std::runtime_error if CHOLMOD
  /// cannot be started or its BLAS must not be used by several threads.
  explicit CholmodFactor(const Supernodes& supernodes);
  explicit CholmodFactor(Supernodes&&) = delete;
  ~CholmodFactor() override;

  bool factorise(const BlockMatrix& A, double shift = 0) noexcept override;

  /// Whether the last factor is CHOLMOD's; false if the own one took over.
  bool is_cholmod() const { return is_cholmod_; }
  /// Duration of CHOLMOD's part of the last call, s of `clock` (monotonic); 0 without a clock.
  double bare_time() const { return bare_time_; }
  void set_clock(double (*clock)()) { clock_ = clock; }

 private:
  struct Parts;

  void lay_out_matrix();
  void lay_out_factor();
  void load(const BlockMatrix& A, const double* scale) noexcept;
  bool take_over(const Storage& storage) noexcept;

  std::unique_ptr<Parts> parts_;
  std::ptrdiff_t border_panel_;  // place of the border's factor behind the panels
  bool is_cholmod_ = false;
  double (*clock_)() = nullptr;
  double bare_time_ = 0;
};

/// A FactorMaker.
std::unique_ptr<SupernodalFactor> make_cholmod_factor(const Supernodes& supernodes);

}  // namespace palpate::factor
