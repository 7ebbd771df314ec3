#pragma once

#include "rt/inference/torch_module.hpp"

namespace palpate::inference {

/// What bin/libpalpate_torch.so offers under the name palpate_torch_functions. It is loaded when
/// the first model is: libtorch is a gigabyte that a daemon with locked memory pays for in full,
/// and only one with a learned model shall.
struct TorchFunctions {
  decltype(&load_torch_module) load;
  decltype(&read_recurrent_weights) read;
  decltype(&write_torch_module) write;
  decltype(&torch_version) version;
};

}  // namespace palpate::inference

extern "C" __attribute__((visibility("default"))) const palpate::inference::TorchFunctions*
palpate_torch_functions();
