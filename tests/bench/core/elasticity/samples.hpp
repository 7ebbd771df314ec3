#pragma once

#include <cstddef>
#include <vector>

namespace palpate::bench {

/// Seconds on the monotonic clock.
double wall_time() noexcept;
/// Seconds of processor time of the calling thread: unaffected by other programs.
double thread_time() noexcept;

/// Every sample is kept, so that quantiles are exact.
class Samples {
 public:
  explicit Samples(std::size_t capacity = 0) { values_.reserve(capacity); }
  void add(double value) { values_.push_back(value); }
  std::size_t count() const { return values_.size(); }
  double mean() const;
  double max() const;
  /// Smallest sample that is exceeded by at most 1 - `fraction` of all; 0 when empty.
  double quantile(double fraction) const;

 private:
  std::vector<double> values_;
};

}  // namespace palpate::bench
