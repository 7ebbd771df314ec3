#pragma once

#include <cstddef>

namespace palpate::inference {

/// Resource limits of a module while it is probed, in addition to what libtorch itself needs.
inline constexpr unsigned kProbeSeconds = 2;  // of processor time
/// Address space, including libtorch's.
inline constexpr std::size_t kProbeMemory = std::size_t{6} << 30;
/// Steps on zeros with a persistent state.
inline constexpr int kProbeSteps = 50;

}  // namespace palpate::inference
