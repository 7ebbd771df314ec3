#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "rt/inference/model_card.hpp"

namespace palpate::torch_script {

struct Tensor {
  std::string name;
  std::vector<std::int64_t> shape;
  std::vector<float> values;  // row by row
};

/// Bytes of a module that has these parameters and whose methods are `source`, in TorchScript: what
/// torch.jit.script(...).save(...) writes of a user's own module.
std::string module(const std::string& source, const std::vector<Tensor>& parameters = {});

/// The body of `def forward(self, x: Tensor, state: Tensor) -> Tuple[Tensor, Tensor]:`.
std::string forward(const std::string& body);

/// Writes a module to `path` and its card, of the architecture "user", beside it.
void write(const std::string& path, const std::string& bytes, inference::ModelCard card);

}  // namespace palpate::torch_script
