#pragma once

#include <Eigen/Core>

namespace palpate::sensing {

/// Rows of signals on a uniform time grid, for delayed means. Before the first row the signals are
/// assumed constant.
class SignalHistory {
 public:
  /// For means over up to `window` rows, delayed by up to `largest_delay` rows. Throws
  /// std::invalid_argument if an argument is out of range (width and window >= 1, delay >= 0, at
  /// most 1e6 rows).
  SignalHistory(int width, int window, double largest_delay);

  void clear() noexcept { count_ = 0; }
  int count() const noexcept { return count_; }  // rows since the last clear()
  /// `row`: length width.
  void push(const Eigen::Ref<const Eigen::VectorXd>& row) noexcept;
  /// Mean of the columns from `first` on, as many as `mean` has entries, over the last `window`
  /// rows, or all available ones, each delayed by `delay` rows (may be fractional). Zero without
  /// any row.
  void mean(int first, double delay, Eigen::Ref<Eigen::VectorXd> mean) const noexcept;

 private:
  Eigen::MatrixXd rows_;  // one column per row of the grid: column k % capacity is row k
  int window_;
  int count_ = 0;
};

}  // namespace palpate::sensing
