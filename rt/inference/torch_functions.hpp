#pragma once

#include "rt/inference/torch_module.hpp"

namespace palpate::inference {

/// Function table exported by bin/libpalpate_torch.so under the name palpate_torch_functions. The
/// library is loaded with the first model, because libtorch occupies a gigabyte, all of it resident
/// in a daemon with locked memory; daemons without a learned model never load it.
struct TorchFunctions {
  decltype(&load_torch_module) load;
  decltype(&read_recurrent_weights) read;
  decltype(&write_torch_module) write;
  decltype(&torch_version) version;
};

}  // namespace palpate::inference

extern "C" __attribute__((visibility("default"))) const palpate::inference::TorchFunctions*
palpate_torch_functions();
