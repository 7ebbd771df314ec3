#pragma once

#include <memory>
#include <string>

#include "rt/inference/model_card.hpp"
#include "rt/inference/torch_executor.hpp"
#include "rt/inference/torch_module.hpp"

namespace palpate::inference {

/// Module and matching model card.
struct ModelFile {
  std::string path;
  std::string bytes;  // content of the module's file
  ModelCard card;
};

/// Maximum size of a module, bytes.
inline constexpr std::size_t kLargestModule = std::size_t{64} << 20;

/// Reads a module and its card. The hash in the card is compared before the module is interpreted,
/// so that a corrupt file never reaches libtorch. Throws ModelError naming file and reason.
ModelFile read_model_file(const std::string& path);

/// Creates the model in libtorch. Throws ModelError.
std::unique_ptr<SequenceModel> make_torch_model(const ModelFile& file);
/// Creates the model in the compiled kernel, after its outputs have been found equal to libtorch's
/// within kAgreement. Throws ModelError, also for an unsupported architecture.
std::unique_ptr<SequenceModel> make_compiled_model(const ModelFile& file);

enum class ExecutorKind { kTorch, kCompiled };

/// Executor of a component: libtorch in a separate thread, or the kernel in the caller's. Throws
/// ModelError.
std::unique_ptr<Executor> make_executor(const ModelFile& file, ExecutorKind kind,
                                        const TorchExecutorOptions& options = {});

/// Writes a module and its card, of which it sets hash, architecture and states. Throws
/// std::runtime_error if a file cannot be written.
void write_model_file(const std::string& path, const sensing::RecurrentWeights& weights,
                      ModelCard card);

}  // namespace palpate::inference
