#ifndef PALPATE_WITHOUT_TORCH

#include <dlfcn.h>

#include <stdexcept>

#include "core/math/blas.hpp"
#include "rt/config/installation.hpp"
#include "rt/inference/torch_functions.hpp"

namespace palpate::inference {
namespace {

/// Loads the library of the program, once. Throws ModelError.
const TorchFunctions& functions() {
  static const TorchFunctions* const kFunctions = [] {
    const std::filesystem::path path = config::companion("libpalpate_torch.so");
    void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
      throw ModelError(std::string("libtorch cannot be loaded: ") + dlerror());
    using Entry = decltype(&palpate_torch_functions);
    const auto entry = reinterpret_cast<Entry>(dlsym(library, "palpate_torch_functions"));
    if (entry == nullptr) throw ModelError(path.string() + ": is not palpate's");
    // Each model has a thread, and the factors have theirs.
    const math::Blas blas = math::hold_blas_to_one_thread(library);
    if (!blas.is_thread_safe) throw ModelError(math::problem_of(blas));
    return entry();
  }();
  return *kFunctions;
}

}  // namespace

std::unique_ptr<SequenceModel> load_torch_module(const std::string& bytes,
                                                 const ModelSizes& sizes) {
  return functions().load(bytes, sizes);
}

// Weights are checked here, because the library with libtorch contains no code of core.
sensing::RecurrentWeights read_recurrent_weights(const std::string& bytes) {
  sensing::RecurrentWeights weights = functions().read(bytes);
  try {
    weights.check();
  } catch (const std::invalid_argument& error) {
    throw ModelError(error.what());
  }
  return weights;
}

std::string write_torch_module(const sensing::RecurrentWeights& weights) {
  weights.check();
  return functions().write(weights);
}

std::string torch_version() { return functions().version(); }

}  // namespace palpate::inference

#endif
