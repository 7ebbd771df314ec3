#pragma once

#include <cstddef>

namespace palpate::inference {

/// What a module may use while it is loaded and tried, beyond what libtorch itself needs.
inline constexpr unsigned kProbeSeconds = 2;                       // of processor time
inline constexpr std::size_t kProbeMemory = std::size_t{6} << 30;  // of addresses, libtorch's too
/// Steps on zeros with the state carried on.
inline constexpr int kProbeSteps = 50;

}  // namespace palpate::inference
