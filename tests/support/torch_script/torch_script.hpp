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

/// Bytes of a module with these parameters whose methods are `source`, in TorchScript: equivalent
/// to the output of torch.jit.script(...).save(...) for a user's module.
std::string module(const std::string& source, const std::vector<Tensor>& parameters = {});

/// The body of `def forward(self, x: Tensor, state: Tensor) -> Tuple[Tensor, Tensor]:`.
std::string forward(const std::string& body);

/// Writes a module to `path` and its card, of the architecture "user", next to it.
void write(const std::string& path, const std::string& bytes, inference::ModelCard card);

}  // namespace palpate::torch_script
