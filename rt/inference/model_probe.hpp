#pragma once

#include <string>

#include "rt/inference/torch_module.hpp"

namespace palpate::inference {

/// Has a module loaded and tried on zeros in a process of its own (bin/palpate-probe) with limits
/// of time and memory, since libtorch's reader crashes on some damaged files and hangs on others,
/// and a module may loop without end. What has passed once is not tried again by this process.
/// Throws ModelError saying why the module cannot be used.
void probe_module(const std::string& bytes, const ModelSizes& sizes);

}  // namespace palpate::inference
