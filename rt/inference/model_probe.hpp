#pragma once

#include <cstddef>
#include <string>

#include "rt/inference/torch_module.hpp"

namespace palpate::inference {

/// Resource limits of a module while it is probed, in addition to what libtorch itself needs.
inline constexpr unsigned kProbeSeconds = 2;  // of processor time
/// Address space, including libtorch's.
inline constexpr std::size_t kProbeMemory = std::size_t{6} << 30;
/// Steps on zeros with a persistent state.
inline constexpr int kProbeSteps = 50;

/// Loads a module and evaluates it on zeros in a separate process (bin/palpate-probe) with limits
/// of time and memory, because libtorch's reader crashes on some corrupt files and hangs on others,
/// and a module may loop indefinitely. A module that has passed is not probed again by this
/// process. Throws ModelError with the reason for rejection.
void probe_module(const std::string& bytes, const ModelSizes& sizes);

}  // namespace palpate::inference
