#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "core/sensing/recurrent_network.hpp"
#include "rt/inference/sequence_model.hpp"

// The only interface to libtorch in rt: its headers are included in torch_module.cpp only, and its
// code is loaded by the first call of a function below.
namespace palpate::inference {

/// Reason for rejecting a model.
class ModelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Loads a TorchScript module of the signature
///   forward(x: Tensor[batch, inputs], state: Tensor[batch, states])
///       -> (y: Tensor[batch, outputs], next_state: Tensor[batch, states])
/// in single precision (README.md describes how to create one). It is frozen, checked on zeros
/// (shapes and types of the output, finite, reproducible) and warmed up; every thread pool is
/// limited to one thread. `bytes`: content of its file. Throws ModelError.
std::unique_ptr<SequenceModel> load_torch_module(const std::string& bytes, const ModelSizes& sizes);

/// Weights of a module written by write_torch_module(). Throws ModelError if a parameter is
/// missing, has another shape or type, or is not finite.
sensing::RecurrentWeights read_recurrent_weights(const std::string& bytes);

/// Module of the signature above, with parameters named as the members of RecurrentWeights (layer
/// k: lstm<k>_input, lstm<k>_hidden, lstm<k>_bias). Throws std::invalid_argument as
/// RecurrentWeights::check.
std::string write_torch_module(const sensing::RecurrentWeights& weights);

/// Version of libtorch.
std::string torch_version();

}  // namespace palpate::inference
