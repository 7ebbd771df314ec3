#pragma once

#include <cstddef>

namespace palpate::bench {

/// What one core of the machine can do at best, here and now.

/// Bytes per second read one after the other from `size` bytes that have just been read before, and
/// so from whichever cache holds them, or from memory.
double read_bandwidth(std::size_t size);

/// Floating-point operations per second of independent fused multiply-adds, each counted as two.
double peak_flops_single();
double peak_flops_double();

}  // namespace palpate::bench
