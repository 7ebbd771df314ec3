#include "tests/bench/core/elasticity/memory_stream.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "core/math/pack.hpp"
#include "tests/bench/core/elasticity/samples.hpp"

namespace palpate::bench {
namespace {

/// The minimum of many, since all disturbances increase the time.
template <class Run>
double least_time(const Run& run) {
  constexpr double kDuration = 0.05;  // s
  constexpr int kFewest = 5;
  run();
  double least = 1e9;
  const double begin = thread_time();
  for (int i = 0; i < kFewest || thread_time() - begin < kDuration; ++i) {
    const double start = thread_time();
    run();
    least = std::min(least, thread_time() - start);
  }
  return least;
}

/// Keeps an otherwise unused result.
volatile double sink;

template <class Pack>
double peak_flops() {
  constexpr int kChains = 12;  // hide the latency of one multiply-add by others
  constexpr int kRepeats = 20000;
  const double seconds = least_time([] {
    // Unknown to the compiler and different from each other, so that no chain can be optimised
    // away.
    const double one = 1 + 0 * sink;
    const Pack a = math::splat<Pack>(one), b = math::splat<Pack>(one / 3);
    std::array<Pack, kChains> sums;
    for (int k = 0; k < kChains; ++k) sums[k] = math::splat<Pack>(k * one);
    for (int i = 0; i < kRepeats; ++i) {
      for (Pack& sum : sums) sum = sum * b + a;
    }
    double total = 0;
    for (const Pack& sum : sums) total += math::sum(sum);
    sink = total;
  });
  return 2.0 * kChains * math::kLanes<Pack> * kRepeats / seconds;
}

}  // namespace

double read_bandwidth(std::size_t size) {
  using math::Pack4d;
  constexpr int kSums = 8;
  const std::size_t count = std::max<std::size_t>(1, size / (kSums * sizeof(Pack4d)));
  const std::vector<double> memory(count * kSums * 4, 1.0);
  // Short blocks are read several times, so that the clock's overhead is negligible.
  const std::size_t repeats = std::max<std::size_t>(1, 1000000 / (8 * memory.size()));
  const double seconds = least_time([&] {
    std::array<Pack4d, kSums> sums{};
    for (std::size_t r = 0; r < repeats; ++r) {
      const double* from = memory.data();
      for (std::size_t i = 0; i < count; ++i) {
        for (Pack4d& sum : sums) {
          sum += math::load(from);
          from += 4;
        }
      }
    }
    double total = 0;
    for (const Pack4d& sum : sums) total += math::sum(sum);
    sink = total;
  });
  return static_cast<double>(8 * memory.size() * repeats) / seconds;
}

double peak_flops_single() { return peak_flops<math::Pack8f>(); }
double peak_flops_double() { return peak_flops<math::Pack4d>(); }

}  // namespace palpate::bench
