#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "core/sensing/recurrent_network.hpp"
#include "rt/inference/sequence_model.hpp"

// The only door to libtorch in rt: its headers are in torch_module.cpp alone, and its code is
// loaded by the first call of a function below.
namespace palpate::inference {

/// Why a model is refused.
class ModelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A TorchScript module of the signature
///   forward(x: Tensor[batch, inputs], state: Tensor[batch, states])
///       -> (y: Tensor[batch, outputs], next_state: Tensor[batch, states])
/// in single precision (README.md tells how to make one). It is frozen, tried on zeros (shapes and
/// types of the answer, finite, the same twice) and warmed up; every thread pool is held to one
/// thread. `bytes` is the content of its file. Throws ModelError.
std::unique_ptr<SequenceModel> load_torch_module(const std::string& bytes, const ModelSizes& sizes);

/// The weights of a module that write_torch_module() wrote. Throws ModelError where a parameter is
/// missing, has another shape or type, or is not finite.
sensing::RecurrentWeights read_recurrent_weights(const std::string& bytes);

/// A module of the signature above, its parameters named as the members of RecurrentWeights
/// (layer k: lstm<k>_input, lstm<k>_hidden, lstm<k>_bias). Throws std::invalid_argument as
/// RecurrentWeights::check.
std::string write_torch_module(const sensing::RecurrentWeights& weights);

/// Version of libtorch.
std::string torch_version();

}  // namespace palpate::inference
