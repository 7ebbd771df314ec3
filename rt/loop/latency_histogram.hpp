#pragma once

#include <array>
#include <cstdint>

namespace palpate::loop {

/// Durations in buckets of about 3 % width (32 per octave) from 64 ns to 68 s. record() costs a few
/// instructions and never allocates; quantiles are upper bucket bounds (at most max), max is exact.
class LatencyHistogram {
 public:
  void record(std::int64_t nanoseconds) noexcept;
  void merge(const LatencyHistogram& other) noexcept;
  void clear() noexcept;
  std::int64_t count() const noexcept { return count_; }
  std::int64_t max_ns() const noexcept { return max_ns_; }
  /// Smallest bucket bound that at least a fraction `fraction` of the samples does not exceed; 0 if
  /// empty.
  std::int64_t quantile_ns(double fraction) const noexcept;
  /// Number of samples above a duration, to the width of a bucket.
  std::int64_t count_above(std::int64_t nanoseconds) const noexcept;

 private:
  static constexpr int kBuckets = 32 * 31;
  std::array<std::int64_t, kBuckets> buckets_{};
  std::int64_t count_ = 0;
  std::int64_t max_ns_ = 0;
};

}  // namespace palpate::loop
