#pragma once

#include <cstddef>

namespace palpate::bench {

/// Peak performance of one core of this machine.

/// Sequential read bandwidth, bytes per second, for `size` bytes that have just been read before,
/// and therefore from the cache that holds them, or from memory.
double read_bandwidth(std::size_t size);

/// Floating-point operations per second of independent fused multiply-adds, each counted as two.
double peak_flops_single();
double peak_flops_double();

}  // namespace palpate::bench
