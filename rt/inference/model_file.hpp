#pragma once

#include <memory>
#include <string>

#include "rt/inference/model_card.hpp"
#include "rt/inference/torch_executor.hpp"
#include "rt/inference/torch_module.hpp"

namespace palpate::inference {

/// A module and its card, found to belong together.
struct ModelFile {
  std::string path;
  std::string bytes;  // of the module
  ModelCard card;
};

/// Largest module that is read, bytes.
inline constexpr std::size_t kLargestModule = std::size_t{64} << 20;

/// Reads a module and its card. The card's hash is compared before anything interprets the module,
/// so that a damaged file never gets as far as libtorch. Throws ModelError naming the file and why.
ModelFile read_model_file(const std::string& path);

/// The module in libtorch. Throws ModelError.
std::unique_ptr<SequenceModel> make_torch_model(const ModelFile& file);
/// The module in palpate's own kernel, once its numbers agree with libtorch's within kAgreement.
/// Throws ModelError, also where the architecture is not the kernel's.
std::unique_ptr<SequenceModel> make_compiled_model(const ModelFile& file);

enum class ExecutorKind { kTorch, kCompiled };

/// What a component holds: libtorch on its own thread, or the kernel in the caller's. Throws
/// ModelError.
std::unique_ptr<Executor> make_executor(const ModelFile& file, ExecutorKind kind,
                                        const TorchExecutorOptions& options = {});

/// Writes a module and its card, whose hash, architecture and states it sets. Throws
/// std::runtime_error where a file cannot be written.
void write_model_file(const std::string& path, const sensing::RecurrentWeights& weights,
                      ModelCard card);

}  // namespace palpate::inference
