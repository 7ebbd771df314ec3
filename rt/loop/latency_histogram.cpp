#include "rt/loop/latency_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::loop {
namespace {

constexpr int kPerOctave = 32;
constexpr int kPerOctaveLog2 = 5;
// Below this the buckets are 2 ns wide, the value that 1/32 of an octave reaches there.
constexpr std::int64_t kLinearBelow = 64;

int bucket_of(std::int64_t nanoseconds) noexcept {
  if (nanoseconds < kLinearBelow) return static_cast<int>(nanoseconds / 2);
  const int octave = 63 - __builtin_clzll(static_cast<unsigned long long>(nanoseconds));
  const int shift = octave - kPerOctaveLog2;
  return shift * kPerOctave + static_cast<int>(nanoseconds >> shift) - kPerOctave;
}

/// Largest whole nanosecond of the bucket.
std::int64_t upper_bound(int bucket) noexcept {
  if (bucket < kPerOctave) return 2 * bucket + 1;
  const int shift = bucket / kPerOctave;
  return (static_cast<std::int64_t>(bucket % kPerOctave + kPerOctave + 1) << shift) - 1;
}

}  // namespace

void LatencyHistogram::record(std::int64_t nanoseconds) noexcept {
  const std::int64_t duration = std::max<std::int64_t>(nanoseconds, 0);
  ++buckets_[std::min(bucket_of(duration), kBuckets - 1)];
  ++count_;
  max_ns_ = std::max(max_ns_, duration);
}

void LatencyHistogram::merge(const LatencyHistogram& other) noexcept {
  for (int i = 0; i < kBuckets; ++i) buckets_[i] += other.buckets_[i];
  count_ += other.count_;
  max_ns_ = std::max(max_ns_, other.max_ns_);
}

void LatencyHistogram::clear() noexcept { *this = LatencyHistogram(); }

std::int64_t LatencyHistogram::quantile_ns(double fraction) const noexcept {
  if (count_ == 0) return 0;
  // The factor prevents a product such as 0.07 * 100 from being rounded up to the next sample.
  const double wanted = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count_) * (1 - 1e-13);
  const auto rank = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(wanted)));
  std::int64_t below = 0;
  for (int i = 0; i < kBuckets - 1; ++i) {
    below += buckets_[i];
    if (below >= rank) return std::min(upper_bound(i), max_ns_);
  }
  return max_ns_;
}

std::int64_t LatencyHistogram::count_above(std::int64_t nanoseconds) const noexcept {
  std::int64_t above = 0;
  for (int i = bucket_of(std::max<std::int64_t>(nanoseconds, 0)) + 1; i < kBuckets; ++i)
    above += buckets_[i];
  return above;
}

}  // namespace palpate::loop
