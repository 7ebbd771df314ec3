#pragma once

#include <Eigen/Core>

namespace palpate::sensing {

/// Rows of signals on a uniform grid of time, of which means over the past are taken. Before the
/// first row the signals are taken to have stood as in it.
class SignalHistory {
 public:
  /// For means over up to `window` rows, delayed by up to `largest_delay` rows. Throws
  /// std::invalid_argument where one of them is out of range (width and window from 1, delay from
  /// 0, at most 1e6 rows).
  SignalHistory(int width, int window, double largest_delay);

  void clear() noexcept { count_ = 0; }
  int count() const noexcept { return count_; }  // rows since the last clear()
  /// `row` of the width.
  void push(const Eigen::Ref<const Eigen::VectorXd>& row) noexcept;
  /// Columns `first`, ... into all of `mean`: over the last `window` rows, or those there are, each
  /// as it was `delay` (rows, also of a fraction) before. Zero without any row.
  void mean(int first, double delay, Eigen::Ref<Eigen::VectorXd> mean) const noexcept;

 private:
  Eigen::MatrixXd rows_;  // a column a row of the grid: column k % capacity is row k
  int window_;
  int count_ = 0;
};

}  // namespace palpate::sensing
